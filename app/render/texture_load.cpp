#include "app/render/texture_load.h"

#include <new>

#include "app/render/png.h"
#include "app/view/texture_file.h"
#include "app/view/texture_pattern.h"

namespace burrhole {
namespace {

/// @returns the pixels of a file with the size that its header has.
Result<Image> read_texture(const std::string& path, TextureKind kind) {
  const auto dims = read_texture_header(path, kind);
  if (!dims) return dims.error();
  auto image = read_png(path);
  if (!image) return bad_input("cannot be read: " + image.error().message + "; save the image again", path);
  if (image->width != dims->x || image->height != dims->y * dims->z) return bad_input("changes while it is read", path);
  return image;
}

}  // namespace

Result<std::shared_ptr<const BoneTextures>> load_textures(const TextureConfig& config) {
  if (!config.any()) return std::shared_ptr<const BoneTextures>();
  auto out = std::make_shared<BoneTextures>();
  out->exterior_edge = config.exterior_edge;
  out->interior_edge = config.interior_edge;
  out->axis = config.axis;
  out->exterior_tiles = is_pattern(config.exterior);
  out->interior_tiles = is_pattern(config.interior) && config.interior_edge.has_value();
  if (out->exterior_tiles) {
    out->exterior = make_exterior_pattern(config.exterior);
  } else if (!config.exterior.empty()) {
    auto image = read_texture(config.exterior, TextureKind::exterior);
    if (!image) return image.error();
    out->exterior = std::move(image).value();
  }
  if (is_pattern(config.interior)) {
    out->interior = make_interior_pattern(config.interior);
  } else if (!config.interior.empty()) {
    auto image = read_texture(config.interior, TextureKind::interior);
    if (!image) return image.error();
    out->interior = {{image->width, image->width, image->height / image->width}, std::move(image->pixels)};
  }
  return std::shared_ptr<const BoneTextures>(std::move(out));
}

}  // namespace burrhole
