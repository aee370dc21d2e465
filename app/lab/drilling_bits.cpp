#include "app/lab/drilling_bits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/bounds.h"
#include "core/base/units.h"
#include "core/config/toml.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "core/voxel/window_size.h"

namespace burrhole {
namespace {

constexpr const char* kFlat = R"(title = "Flat end, 4 mm"

[shell]
pitch_mm = 0.4

[[region]]
name = "cutter"
shape = "cylinder"
z_mm = 0
height_mm = 3
diameter_mm = 4
erosion_factor = 0.2

[[region]]
name = "shank"
shape = "cylinder"
z_mm = 3
height_mm = 9
diameter_mm = 3
erosion_factor = 0
pitch_mm = 1
)";

constexpr const char* kCone = R"(title = "Cone of 90 degrees, 8 mm"

[shell]
pitch_mm = 0.5

[[region]]
name = "cutter"
shape = "cone"
z_mm = 0
height_mm = 4
diameter_mm = 8
erosion_factor = 0.2

[[region]]
name = "shank"
shape = "cylinder"
z_mm = 4
height_mm = 8
diameter_mm = 5
erosion_factor = 0
pitch_mm = 1
)";

constexpr const char* kStepped = R"(title = "Stepped drill, 9/6 mm"

[shell]
pitch_mm = 0.6

[[region]]
name = "inner drill"
shape = "frustum"
z_mm = 0
height_mm = 3
bottom_diameter_mm = 6
top_diameter_mm = 5.8
erosion_factor = 0.1

[[region]]
name = "outer drill"
shape = "frustum"
z_mm = 3
height_mm = 3
bottom_diameter_mm = 9
top_diameter_mm = 8.7
erosion_factor = 0.1

[[region]]
name = "shank"
shape = "cylinder"
z_mm = 6
height_mm = 6
diameter_mm = 6
erosion_factor = 0
pitch_mm = 1
)";

}  // namespace

const std::vector<DrillingBit>& drilling_bits() {
  static const std::vector<DrillingBit> bits{
      {"ball 6 mm", "round_burr_6mm", {}, {3e-3, 0.0}, 3e-3, 0.0625, "region[1].height_mm=8.4"},
      {"ball 2 mm", "round_burr_2mm", {}, {1e-3, 0.0}, 1e-3, 0.0625, "region[1].height_mm=10.8"},
      {"flat 4 mm", {}, kFlat, {2e-3, 0.0}, 0.0, 0.0625},
      {"cone 8 mm", {}, kCone, {4e-3, 0.0}, 4e-3, 0.0625},
      {"perforator 14/11 mm", "perforator_14_11", {}, {7e-3, 0.0}, 3e-3, 0.1, "region[3].height_mm=10"},
      {"trephine 12 mm", "trephine_12mm", {}, {6e-3, 5e-3}, 0.0, 0.1, "region[3].height_mm=7"},
      {"stepped 9/6 mm", {}, kStepped, {4.5e-3, 0.0}, 3e-3, 0.0625},
  };
  return bits;
}

const DrillingBit* find_drilling_bit(const std::string& name) {
  const auto found = std::ranges::find(drilling_bits(), name, &DrillingBit::name);
  return found == drilling_bits().end() ? nullptr : &*found;
}

std::string drilling_bit_names() {
  std::string out;
  for (const DrillingBit& one : drilling_bits()) out += (out.empty() ? "" : ", ") + one.name;
  return out;
}

Result<DrillingBit> own_drilling_bit(const std::string& name, const std::string& text) {
  constexpr double kFinest = 0.0625;    // [mm] as of the pinned shapes
  constexpr double kRoundTheBit = 1.6;  // [-] volume of the window over that of the box round the bit
  constexpr double kEven = 1e-9;        // [m] radii that differ by less are the same
  const auto document = TomlDocument::parse(text, name);
  if (!document) return document.error();
  if (has_tool_mesh(*document))
    return bad_input("the drilling study compares a hole with its closed form, which a mesh has not: give a bit with regions", name);
  Issues issues;
  const auto spec = read_tool_spec(*document, issues);
  if (!spec) return issues.front();
  DrillingBit out;
  out.name = name;
  out.text = text;
  bool crown = true;
  double bore = std::numeric_limits<double>::max();
  Bounds box = Bounds::none();
  for (const RegionSpec& region : spec->regions) {
    const Solid& solid = region.solid;
    box.include(solid.bounds().lo);
    box.include(solid.bounds().hi);
    if (region.erosion.base <= 0.0) continue;
    if (!solid.revolves())
      return bad_input("region \"" + region.name + "\" does not revolve: a hole of such a bit has no closed form", name);
    const double widest = solid.low_radius >= solid.high_radius ? solid.z_low : solid.z_high;
    const double at = solid.kind == SolidKind::ellipsoid ? 0.5 * (solid.z_low + solid.z_high) : widest;
    if (solid.largest_radius() > out.swept.radius + kEven) out.widest_at = at;
    out.swept.radius = std::max(out.swept.radius, solid.largest_radius());
    crown = crown && solid.bored();
    bore = std::min({bore, solid.low_bore, solid.high_bore});
  }
  if (out.swept.radius <= 0.0) return bad_input("the bit does not cut: give a region an erosion_factor", name);
  if (crown) out.swept.bore = bore;
  const Vec3 size = (box.hi - box.lo) / kMillimetre;
  out.finest_mm = std::max(kFinest, std::cbrt(kRoundTheBit * size.x * size.y * size.z / static_cast<double>(kMaxWindowVoxels)));
  return out;
}

Result<std::string> drilling_bit_text(const DrillingBit& bit, const std::string& tool_folder) {
  if (bit.shipped.empty()) return bit.text;
  auto tool = TomlDocument::load(tool_folder + "/" + bit.shipped + ".toml");
  if (!tool) return tool.error();
  if (Status set = tool->set(bit.short_shank); !set) return set.error();
  return tool->to_text();
}

}  // namespace burrhole
