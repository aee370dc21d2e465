#include "app/cli/picture_sink.h"

namespace burrhole::cli {

Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayScene&, const PictureAsked&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer: take [display] out of the scene", {}};
}

}  // namespace burrhole::cli
