#include "app/lab/stability_parts.h"

#include <fmt/format.h>

#include <array>

#include "core/base/units.h"

namespace burrhole {

std::span<const StabilityModel> stability_models() {
  static const std::array<StabilityModel, 9> models{
      {{.name = "surface", .keys = "model = \"surface\"\n", .constrained = true},
       {.name = "surface, felt hardness", .keys = "model = \"surface\"\nfelt_hardness = 0.6\n", .constrained = true},
       {.name = "gradient-plane", .keys = "model = \"gradient-plane\"\n"},
       {.name = "voxmap", .keys = "model = \"voxmap\"\n"},
       {.name = "mesh", .keys = "model = \"mesh\"\n", .constrained = true},
       {.name = "mesh, tool at the hand", .keys = "model = \"mesh\"\ntool = \"hand\"\n"},
       {.name = "gradient-plane, virtual coupling", .keys = "model = \"gradient-plane\"\ncoupling = \"virtual\"\n"},
       {.name = "voxmap, virtual coupling", .keys = "model = \"voxmap\"\ncoupling = \"virtual\"\n"},
       {.name = "mesh, virtual coupling", .keys = "model = \"mesh\"\ntool = \"hand\"\ncoupling = \"virtual\"\n"}}};
  return models;
}

std::vector<StabilityCase> stability_cases(bool long_runs) {
  std::vector<StabilityCase> out;
  stability::add_shapes(out);
  stability::add_motions(out);
  stability::add_drilling(out);
  stability::add_troubles(out, long_runs);
  return out;
}

namespace stability {

std::string ball(double pitch_mm) {
  return fmt::format(
      "title = \"Ball of 4 mm\"\n[shell]\npitch_mm = {}\n[[region]]\nname = \"ball\"\nshape = \"sphere\"\nz_mm = 0\n"
      "diameter_mm = 4\nerosion_factor = 0.2\n",
      pitch_mm);
}

std::string pin(double diameter_mm, double pitch_mm) {
  return fmt::format(
      "title = \"Flat cylinder\"\n[shell]\npitch_mm = {}\n[[region]]\nname = \"pin\"\nshape = \"cylinder\"\nz_mm = 0\n"
      "height_mm = 5\ndiameter_mm = {}\nerosion_factor = 0.2\n",
      pitch_mm, diameter_mm);
}

std::string cone(double diameter_mm, double height_mm, double pitch_mm) {
  return fmt::format(
      "title = \"Cone\"\n[shell]\npitch_mm = {0}\n[[region]]\nname = \"cone\"\nshape = \"cone\"\nz_mm = 0\nheight_mm = {1}\n"
      "diameter_mm = {2}\nerosion_factor = 0.2\n[[region]]\nname = \"shaft\"\nshape = \"cylinder\"\nz_mm = {1}\nheight_mm = 4\n"
      "diameter_mm = {2}\nerosion_factor = 0\n",
      pitch_mm, height_mm, diameter_mm);
}

std::string blade(double width_mm, double depth_mm, double pitch_mm) {
  return fmt::format(
      "title = \"Blade\"\n[shell]\npitch_mm = {}\n[[region]]\nname = \"blade\"\nshape = \"box\"\nz_mm = 0\nheight_mm = 5\n"
      "width_mm = {}\ndepth_mm = {}\nerosion_factor = 0.2\n",
      pitch_mm, width_mm, depth_mm);
}

std::string scene(const SceneParts& parts) {
  return fmt::format(
      "title = \"Hard case\"\n[volume]\n{}\n[tool]\nname = \"case\"\nspin_rpm = {}\nerosion_scale = 10\n[approach]\nentry_mm = [{}, {}, "
      "0]\n[hand]\n"
      "[device]\nname = \"generic\"\nhand = \"nominal\"\nforce_scale = {}\n{}[servo]\nforce_N = {}\n{}",
      parts.volume, parts.drills ? 1000.0 : 0.0, parts.entry_x_mm, parts.entry_y_mm, 8.0 / kForceLimit,
      parts.exact ? "step_mm = 0\nfriction_N = 0\n" : "", kForceLimit, parts.drills ? "[erosion]\n" : "");
}

std::string plate(const std::string& more) { return "source = \"phantom:plate\"\nextent_mm = [16, 16, 10]\nthickness_mm = 7\n" + more; }

std::vector<Waypoint> press(double depth_mm, double x_mm) {
  const auto at = [&](double z_mm) { return Vec3(x_mm, 0.0, z_mm) * kMillimetre; };
  return {{0.0, at(1.0)}, {0.5, at(-depth_mm)}, {1.5, at(-depth_mm)}, {1.8, at(3.0)}};
}

std::vector<StabilityCheck> always() {
  return {{StabilityMeasure::not_finite, 0.0},
          {StabilityMeasure::force, kForceBound},
          {StabilityMeasure::force_without_bone, 0.0},
          {StabilityMeasure::passivity_deficit, kEnergy}};
}

std::vector<StabilityCheck> pressed() {
  return with(always(), {{StabilityMeasure::cycle, kCycle, kPressed},
                         {StabilityMeasure::ripple, kRipple, kPressed},
                         {StabilityMeasure::attractive_force, kAttractiveForce, {1.5, kPressTime}},
                         {StabilityMeasure::rest_speed, kRestSpeed, kLeft}});
}

std::vector<StabilityCheck> with(std::vector<StabilityCheck> checks, std::vector<StabilityCheck> more) {
  checks.insert(checks.end(), more.begin(), more.end());
  return checks;
}

std::vector<StabilityCheck> held_back(double penetration) {
  return {{StabilityMeasure::penetration, penetration, {}, ForModels::constrained}, {StabilityMeasure::far_side, 0.0}};
}

}  // namespace stability
}  // namespace burrhole
