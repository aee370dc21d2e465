#include "app/effect/display_skin.h"

#include <memory>

#include "core/base/units.h"
#include "volumes/phantom/head_shape.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_skin.h"

namespace burrhole {
namespace {

/// @returns why the volume has no skin; empty if it has one.
std::string why_no_skin(const VolumeScene& volume) {
  constexpr const char* kNeeds = "needs a whole head: volume.source = \"phantom:head\", or a CT without region_mm";
  if (volume.phantom) return volume.phantom->kind == PhantomKind::head ? std::string() : kNeeds;
  if (!volume.scan) return {};
  if (volume.scan->region) return kNeeds;
  const std::string& path = volume.scan->request.path;
  for (const char* ending : {".vdb", ".stl", ".obj", ".ply"})
    if (path.ends_with(ending)) return std::string("needs a CT: a file ") + ending + " has bone alone";
  return {};
}

}  // namespace

void read_skin(TableReader& table, const StageConfig& scene, DisplayConfig& out) {
  const bool on = table.boolean("skin", false,
                                "the skin of a whole head as a translucent shell with an opening at the entry: that of \"phantom:head\" is "
                                "assumed, that of a CT is its surface between air and soft tissue");
  if (!on) return;
  SkinConfig skin;
  if (out.drape) {
    skin.window = out.drape->window - 2.0 * skin.shown;
    skin.round = out.drape->round;
    skin.reach = 3.0 * skin.shown;
  }
  skin.opacity = table.number("skin_opacity", {.fallback = skin.opacity, .min = 0.0, .max = 1.0},
                              "share of the light that the skin takes where it is seen square on; it takes more at an angle");
  skin.window =
      table.number("skin_window_mm", {.fallback = skin.window / kMillimetre, .min = 1.0, .max = 200.0, .to_si = kMillimetre},
                   "width of the opening, which is round, or has the shape of the drape's window and is by default smaller than it");
  if (!draws_surface(out)) return table.fault("skin", "needs method = \"raycast\" with shading = \"surface\", or method = \"mesh\"");
  if (const std::string why = why_no_skin(scene.volume); !why.empty()) return table.fault("skin", why);
  out.skin = skin;
}

Status find_skin(const VolumeScene& volume, SkinConfig& skin) {
  if (volume.phantom) {
    skin.body = [](const Vec3& p) { return HeadShape::skin(p); };
    skin.box = HeadShape::skin_box();
    return {};
  }
  const ImportRequest& request = volume.scan->request;
  const auto at_scan = [&](const Error& error) { return Error{error.code, "display.skin: " + error.message, request.path}; };
  auto read = read_scan(request.path, request.read);
  if (!read) return read.error();
  const auto offset = find_hu_offset(read->scan, request.bone);
  if (!offset) return at_scan(offset.error());
  auto found = find_scan_skin(read->scan, *offset, skin.pitch);
  if (!found) return at_scan(found.error());
  const auto shape = std::make_shared<const ScanSkin>(std::move(found).value());
  skin.body = [shape](const Vec3& p) { return shape->at(p); };
  skin.box = shape->box();
  return {};
}

}  // namespace burrhole
