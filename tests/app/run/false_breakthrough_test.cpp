// The hand of a scene takes no entry for a breakthrough: a point that rests on few voxels, and a coupling so soft that hardly any force is
// missing where a bit leaves bone.

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "app/stage/stage.h"
#include "core/measure/approach.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kThick = 3e-3;  // [m]
constexpr const char* kCone =
    "title = \"Cone\"\n[shell]\npitch_mm = 0.5\n[[region]]\nshape = \"cone\"\nz_mm = 0\nheight_mm = 4\ndiameter_mm = 8\nerosion_factor = "
    "0.2\n"
    "[[region]]\nshape = \"cylinder\"\nz_mm = 4\nheight_mm = 8\ndiameter_mm = 5\nerosion_factor = 0\npitch_mm = 1\n";
constexpr const char* kFlat =
    "title = \"Flat\"\n[shell]\npitch_mm = 0.4\n[[region]]\nshape = \"cylinder\"\nz_mm = 0\nheight_mm = 3\ndiameter_mm = 4\nerosion_factor "
    "= "
    "0.2\n[[region]]\nshape = \"cylinder\"\nz_mm = 3\nheight_mm = 9\ndiameter_mm = 3\nerosion_factor = 0\npitch_mm = 1\n";

/// [m] that the tip comes to before the hand withdraws. @param sabotaged the hand does not know how rough voxels are.
double reached(const char* tool, double spacing_mm, double push, const std::vector<std::string>& sets = {}, bool sabotaged = false) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("bit.toml")) << tool;
  std::vector<std::string> all{"volume.spacing_mm=" + std::to_string(spacing_mm), "hand.push_N=" + std::to_string(push),
                               "tool.name=" + folder.file("bit.toml")};
  all.insert(all.end(), sets.begin(), sets.end());
  LoadedScene loaded = load_text(
      "title = \"Entry\"\nduration_s = 30\n[volume]\nsource = \"phantom:plate\"\nextent_mm = [12, 12, 6]\nabove_mm = 1.5\nthickness_mm = "
      "3\nhardness = 0.8\n[tool]\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n[hand]\nstandoff_mm = 1\n[contact]\n[erosion]\n",
      all);
  const Scene& scene = loaded.scene;
  const auto approach = make_approach(*loaded.bone, scene.approach);
  REQUIRE(approach);
  HandConfig config = hand_config(scene, scene.effects.needs(scene), spacing_mm * 1e-3);
  if (sabotaged) config.rough_drop = 0.0;
  auto hand = SimulatedHand::create(config, scene.volume.world_from_bone * approach->bone_from_approach, 1.0 / scene.servo_hz);
  REQUIRE(hand);
  SimulationOptions options;
  options.hand = &*hand;
  DrillRun run(std::move(loaded), options);
  run.run();
  double deepest = 0.0;
  for (const auto& sample : run.simulation().samples()) deepest = std::max(deepest, sample.depth);
  return deepest;
}

TEST_CASE("hand: a cone enters coarse voxels at any push and is no breakthrough, which it is to a hand that does not know them") {
  CHECK(reached(kCone, 0.3125, 15.0) > kThick);
  CHECK(reached(kCone, 0.3125, 40.0) > kThick);
  CHECK(reached(kCone, 0.5, 28.0) > kThick);
  CHECK(reached(kCone, 0.3125, 28.0, {}, true) < 0.5 * kThick);
}

TEST_CASE("hand: the end of the ramp is no breakthrough, however soft the coupling or stiff the bit in bone") {
  CHECK(reached(kFlat, 0.25, 28.0, {"contact.coupling_N_per_m=1250"}) > kThick);
  CHECK(reached(kFlat, 0.25, 28.0, {"contact.cutting_N_per_m=560e3", "tool.erosion_scale=4"}) > kThick);
}

}  // namespace
}  // namespace burrhole::test
