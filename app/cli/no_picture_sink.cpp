#include "app/cli/picture_sink.h"

namespace burrhole::cli {

Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig&, const PictureAsked&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer: take [display] out of the scene", {}};
}

Status write_tip_slices(const std::string&, const TipSlices&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, which writes pictures", {}};
}

}  // namespace burrhole::cli
