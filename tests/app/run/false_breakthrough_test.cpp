// The hand of a scene takes no bone for its end: not a point that rests on few voxels, nor a coupling so soft that hardly any force is
// missing where a bit leaves bone, nor a pore of the diploe under a round burr, which cuts least there. Where it does, it checks the hole and
// drills on.

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "app/lab/drilling_bits.h"
#include "tests/support/drill_scene.h"
#include "tests/support/scene_hand.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

using Sets = std::vector<std::string>;
using Sabotage = std::function<void(HandConfig&)>;

constexpr const char* kPlate = R"(title = "Plate"
duration_s = 30
[volume]
source = "phantom:plate"
extent_mm = [12, 12, 6]
above_mm = 1.5
thickness_mm = 3
hardness = 0.8
[tool]
spin_rpm = 1000
[approach]
entry_mm = [0, 0, 0]
[hand]
standoff_mm = 1
[contact]
[erosion]
)";

/// @returns whether the default hand drills through before it withdraws. @param sabotage takes from what the hand knows.
bool drills_through(LoadedScene loaded, const Sabotage& sabotage = {}) {
  SimulatedHand hand = scene_hand(loaded, [&](HandConfig& config) {
    config.resumes = false;  // a hand that checks the hole drills on
    if (sabotage) sabotage(config);
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  run.run();
  double deepest = 0.0;
  for (const RunSample& sample : run.simulation().samples()) deepest = std::max(deepest, sample.depth);
  return deepest > run.simulation().approach().thickness;
}

/// @returns whether the hand of the parietal scene, which starts with a perforator, drills through before it withdraws. @param inputs in order.
bool drills_through_with(std::vector<Input> inputs) {
  SimulationOptions options;
  options.inputs = std::move(inputs);
  options.history = true;
  DrillRun run(load_parietal({"hand.resumes=false"}), options);
  run.run();
  const Simulation& simulation = run.simulation();
  CHECK(simulation.inputs_left().empty());
  return simulation.progress().deepest > simulation.approach().thickness;
}

/// A plate and a bit of the drilling study.
LoadedScene plate(const char* bit, double spacing_mm, double push, const Sets& sets = {}) {
  const TemporaryFolder folder;
  const auto text = drilling_bit_text(*find_drilling_bit(bit), in_source("app/tools"));
  REQUIRE(text);
  std::ofstream(folder.file("bit.toml")) << *text;
  Sets all{"volume.spacing_mm=" + std::to_string(spacing_mm), "hand.push_N=" + std::to_string(push),
           "tool.name=" + folder.file("bit.toml")};
  all.insert(all.end(), sets.begin(), sets.end());
  return load_text(kPlate, all);
}

TEST_CASE("hand: a cone enters coarse voxels at any push and is no breakthrough, which it is to a hand that does not know them") {
  CHECK(drills_through(plate("cone 8 mm", 0.3125, 15.0)));
  CHECK(drills_through(plate("cone 8 mm", 0.3125, 28.0)));
  CHECK(drills_through(plate("cone 8 mm", 0.3125, 40.0)));
  CHECK(drills_through(plate("cone 8 mm", 0.5, 28.0)));
  // Which thrusts deceive a hand that does not know the voxels depends on how the first of them break away; these two do.
  CHECK_FALSE(drills_through(plate("cone 8 mm", 0.3125, 15.0), [](HandConfig& hand) { hand.rough_drop = 0.0; }));
  CHECK_FALSE(drills_through(plate("cone 8 mm", 0.5, 28.0), [](HandConfig& hand) { hand.rough_drop = 0.0; }));
}

TEST_CASE("hand: the end of the ramp is no breakthrough, however soft the coupling or stiff the bit in bone") {
  CHECK(drills_through(plate("flat 4 mm", 0.25, 28.0, {"contact.coupling_N_per_m=1250"})));
  CHECK(drills_through(plate("flat 4 mm", 0.25, 28.0, {"contact.cutting_N_per_m=560e3", "tool.erosion_scale=4"})));
}

TEST_CASE("hand: a round burr crosses the pores of the diploe, where it is faster than soft bone is for a bit of one factor") {
  const Sets burr{"tool.name=round_burr_4mm"};
  CHECK(drills_through(load_parietal(burr)));
  CHECK_FALSE(drills_through(load_parietal(burr), [](HandConfig& hand) { hand.softest = 4.0; }));
}

TEST_CASE("hand: a burr that replaces a perforator crosses the pores too: the limit of the feed is that of the tool in hand") {
  auto burr = read_tool_text("round_burr_4mm", "parietal.toml", test_context());
  REQUIRE(burr);
  CHECK(drills_through_with({{100, InputKind::tool, 0.0, "round_burr_4mm", *burr}}));
}

TEST_CASE("hand: bone that comes back under a spinning bit, and its soft start, are no breakthrough") {
  auto perforator = read_tool_text("perforator_14_11", "parietal.toml", test_context());
  REQUIRE(perforator);
  CHECK(drills_through_with({{4000, InputKind::undo, 0.0, {}, {}}}));
  CHECK(drills_through_with({{4000, InputKind::tool, 0.0, "perforator_14_11", *perforator}}));
}

TEST_CASE(
    "hand: a narrow bit that falls into the diploe is no breakthrough to a hand that checks the hole: it goes on to the end of bone") {
  for (const double push : {15.0, 20.0, 28.0}) {
    for (const int seed : {1, 2}) {
      CAPTURE(push);
      CAPTURE(seed);
      const Sets sets{"tool.name=twist_drill_2_5mm", "hand.push_N=" + std::to_string(push), "hand.seed=" + std::to_string(seed)};
      DrillRun run(load_parietal(sets));
      run.run();
      CHECK(run.simulation().progress().deepest > run.simulation().approach().thickness);
      CHECK(run.simulation().progress().breakthrough_time.has_value());
    }
  }
  // One that does not check stops there.
  CHECK_FALSE(drills_through(load_parietal({"tool.name=twist_drill_2_5mm"})));
}

}  // namespace
}  // namespace burrhole::test
