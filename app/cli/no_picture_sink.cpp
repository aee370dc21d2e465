#include "app/cli/film.h"
#include "app/cli/picture_sink.h"
#include "app/cli/volume_picture.h"

namespace burrhole::cli {

Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig&, const PictureOptions&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer: remove [display] from the scene", {}};
}

Result<std::unique_ptr<FilmWriter>> FilmWriter::create(const FilmOptions&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot draw a film", {}};
}

Status write_tip_slices(const std::string&, int, int, const std::function<TipSlices(int)>&, const std::vector<std::string>&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot write pictures", {}};
}

Result<std::string> write_volume_picture(const std::string&, const BoneModel&, const VolumePicture&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot draw a volume", {}};
}

Result<std::string> write_volume_sheet(const std::string&, const BoneModel&, const Bounds&, const VolumePicture&) {
  return Error{ErrorCode::unavailable, "this program was built without the renderer, so it cannot draw a volume", {}};
}

}  // namespace burrhole::cli
