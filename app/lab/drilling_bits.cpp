#include "app/lab/drilling_bits.h"

#include <algorithm>

#include "core/config/toml.h"

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

Result<std::string> drilling_bit_text(const DrillingBit& bit, const std::string& tool_folder) {
  if (bit.shipped.empty()) return bit.text;
  auto tool = TomlDocument::load(tool_folder + "/" + bit.shipped + ".toml");
  if (!tool) return tool.error();
  if (Status set = tool->set(bit.short_shank); !set) return set.error();
  return tool->to_text();
}

}  // namespace burrhole
