// The hand of a scene that feels the hardness of bone: diploe takes force off the hand and lets it advance, which is no breakthrough, and the exit
// is one as without.

#include <doctest/doctest.h>

#include <algorithm>

#include "app/stage/stage.h"
#include "core/measure/approach.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

struct Drilled {
  double through = 0.0, detected = 0.0;  ///< [s] no bone is left on the axis; the hand first detects a breakthrough
  double beyond = 0.0;                   ///< [m] of the tip from the end of bone on the axis to its deepest place
  double plunge = 0.0;                   ///< [m]
};

/// @param watches false: sabotage, the hand follows the force alone.
Drilled drilled(double felt_hardness, bool watches = true) {
  LoadedScene loaded = load_parietal({"contact.felt_hardness=" + std::to_string(felt_hardness)});
  const Scene& scene = loaded.scene;
  const auto approach = make_approach(*loaded.bone, scene.approach);
  REQUIRE(approach);
  HandConfig config = hand_config(scene, scene.effects.needs(scene), loaded.tool, loaded.bone->bone_from_index().mean_edge());
  CHECK(config.watches_drill == (felt_hardness > 0.0));
  config.watches_drill = config.watches_drill && watches;
  auto hand = SimulatedHand::create(config, scene.volume.world_from_bone * approach->bone_from_approach, 1.0 / scene.servo_hz);
  REQUIRE(hand);
  SimulationOptions options;
  options.hand = &*hand;
  DrillRun run(std::move(loaded), options);
  run.run();
  const Simulation& simulation = run.simulation();
  const auto detected = std::ranges::find(simulation.events(), "breakthrough detected", &RunEvent::text);
  REQUIRE(detected != simulation.events().end());
  REQUIRE(simulation.progress().breakthrough_time);
  return {*simulation.progress().breakthrough_time, detected->time, simulation.progress().deepest - approach->thickness,
          simulation.progress().loss ? simulation.progress().loss->plunge : 0.0};
}

}  // namespace

TEST_CASE("hand: tables and diploe that are felt are no breakthrough, the exit is, and without a plunge") {
  const Drilled plain = drilled(0.0), felt = drilled(0.6), alone = drilled(0.6, false);
  MESSAGE("through after " << plain.through << " s, felt " << felt.through << " s, by the force alone " << alone.through
                           << " s; beyond bone " << 1e3 * plain.beyond << ", " << 1e3 * felt.beyond << " mm; plunge " << 1e3 * plain.plunge
                           << ", " << 1e3 * felt.plunge << " mm");
  // The thrust, and so the feed, is that of the hand, whatever the coupling; while the hand advances the drill has a little less of it.
  CHECK(felt.through < plain.through + 0.5);
  CHECK(felt.detected > felt.through - 0.1);
  CHECK(felt.detected - felt.through < plain.detected - plain.through + 0.05);  // not later
  CHECK(felt.plunge < 0.5e-3);                                                  // the limit of [outcome]: that of the dura
  // A softer spring is longer, so the hand comes back more slowly while the thrust falls, and the bit, which still cuts, goes on: by less than its
  // engaged depth, 28 N / 140 kN/m.
  CHECK(felt.beyond < plain.beyond + 0.2e-3);
  // Sabotage: such a hand stops in bone.
  CHECK(alone.detected < alone.through - 1.0);
  CHECK(alone.through > felt.through + 2.0);
}

}  // namespace burrhole::test
