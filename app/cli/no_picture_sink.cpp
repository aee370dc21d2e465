#include "app/cli/film.h"
#include "app/cli/picture_sink.h"

namespace burrhole::cli {

Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig&, const PictureOptions&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer: remove [display] from the scene", {}};
}

Result<std::unique_ptr<FilmWriter>> FilmWriter::create(const std::string&, int) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot draw a film", {}};
}

Status write_tip_slices(const std::string&, const TipSlices&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot write pictures", {}};
}

}  // namespace burrhole::cli
