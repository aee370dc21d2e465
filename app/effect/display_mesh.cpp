#include "app/effect/display_mesh.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/view/texture_file.h"
#include "app/view/texture_pattern.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "volumes/read/written_path.h"

namespace burrhole {
namespace {

std::string name_list() {
  std::string out;
  for (const std::string& name : pattern_names()) out += "\"" + name + "\", ";
  return out;
}

/// @returns the name of a pattern or the path of a file that may be a texture; empty: none, or an error at the key.
std::string read_texture(TableReader& table, const char* key, const StageConfig& scene, TextureKind kind, const char* about) {
  const std::string written = table.text(key, std::string(), about);
  if (written.empty() || is_pattern(written)) return written;
  if (!written.ends_with(".png") && written.find('/') == std::string::npos) {
    const auto near = nearest_name(written, pattern_names());
    table.fault(
        key, fmt::format("must be {}or the path of a PNG file{}", name_list(), near ? "; did you mean \"" + *near + "\"?" : std::string()));
    return {};
  }
  const auto path = written_path(written, scene.file, "");
  if (!path) {
    table.fault(key, "cannot be found: " + path.error().message);
    return {};
  }
  std::error_code ignored;
  if (!std::filesystem::exists(*path, ignored)) {
    table.fault(key, "is not there: tried " + *path);
    return {};
  }
  if (const auto header = read_texture_header(*path, kind); !header) {
    table.fault(key, header.error().message);
    return {};
  }
  return *path;
}

}  // namespace

void read_mesh_colors(TableReader& table, const StageConfig& scene, DisplayConfig& out) {
  TextureConfig textures;
  textures.exterior =
      read_texture(table, "exterior_texture", scene, TextureKind::exterior,
                   "image on the surface as loaded, projected along three axes and blended by the normal: \"bone\", \"apple\", "
                   "\"cucumber\", or the path of a PNG file; absent: none");
  textures.interior =
      read_texture(table, "interior_texture", scene, TextureKind::interior,
                   "volume on faces made by cutting and on sections: the same names, or the path of a PNG file with square slices "
                   "in a column; absent: none");
  const auto scale = [](const std::string& name) { return is_pattern(name) ? pattern_scale(name) : PatternScale{}; };
  textures.exterior_edge = table
                               .optional_number("exterior_mm", above_zero(0.0, kMillimetre, 5000.0),
                                                "edge of one repeat of exterior_texture; default 20, of \"apple\" 60, of \"cucumber\" 40")
                               .value_or(scale(textures.exterior).exterior_edge);
  textures.interior_edge =
      table.optional_number("interior_mm", above_zero(0.0, kMillimetre, 5000.0),
                            "edge of one repeat of interior_texture; default 12 of \"bone\", others span the box of the bone "
                            "as loaded");
  if (!textures.interior_edge) textures.interior_edge = scale(textures.interior).interior_edge;
  const std::string axis = table.choice("texture_axis", "z", {"x", "y", "z"}, "axis of the bone frame along which textures stand");
  textures.axis = axis[0] - 'x';
  const auto colour = table.optional_choice("colour", {"texture", "voxel", "plain"},
                                            "colours of a mesh: texture: the textures that are named; voxel: by tissue and mineral "
                                            "density; plain: one ivory colour; default texture "
                                            "where one is named, otherwise by label_colours");
  if (colour && table.has("label_colours")) table.fault("label_colours", "is given by colour: remove one of the two");
  if (colour == "texture" && !table.has("exterior_texture") && !table.has("interior_texture"))
    table.fault("colour", "needs exterior_texture or interior_texture");
  if (colour && *colour != "texture") textures.exterior.clear(), textures.interior.clear();
  if (colour) out.appearance.labels = *colour != "plain";
  out.textures = textures;
}

}  // namespace burrhole
