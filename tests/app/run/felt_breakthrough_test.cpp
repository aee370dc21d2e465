// The hand of a scene that feels the hardness of bone: diploe takes force off the hand and lets it advance, which is no breakthrough, and the exit
// is one as without.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/stage/stage.h"
#include "tests/support/drill_scene.h"
#include "tests/support/scene_hand.h"

namespace burrhole::test {
namespace {

struct Drilled {
  double through = 0.0, detected = 0.0;  ///< [s] no bone is left on the axis; the hand first detects a breakthrough
  double speed = 0.0;                    ///< [m/s] of the tip in the second half of the reaction time, which follows
  double beyond = 0.0;                   ///< [m] of the tip from the end of bone on the axis to its deepest place
  double plunge = 0.0;                   ///< [m]
  HandConfig hand;
  double coupling = 0.0;  ///< [N/m]
  double bone_hz = 0.0;   ///< [1/s] bone steps
};

/// @param watches false: sabotage, the hand follows the force alone.
Drilled drilled(double felt_hardness, bool watches = true) {
  Drilled out;
  LoadedScene loaded = load_parietal({"contact.felt_hardness=" + std::to_string(felt_hardness)});
  SimulatedHand hand = scene_hand(loaded, [&](HandConfig& config) {
    CHECK(config.watches_drill == (felt_hardness > 0.0));
    config.watches_drill = config.watches_drill && watches;
    out.hand = config;
  });
  const Needs needs = loaded.scene.effects.needs(loaded.scene);
  out.coupling = needs.coupling_stiffness;
  out.bone_hz = needs.simulation_hz;
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  run.run();
  const Simulation& simulation = run.simulation();
  const auto detected = std::ranges::find(simulation.events(), "breakthrough detected", &RunEvent::text);
  REQUIRE(detected != simulation.events().end());
  REQUIRE(simulation.progress().breakthrough_time);
  out.through = *simulation.progress().breakthrough_time;
  out.detected = detected->time;
  const auto depth_at = [&](double time) {
    const auto at = std::ranges::lower_bound(simulation.samples(), time, {}, &RunSample::time);
    REQUIRE(at != simulation.samples().end());
    return at->depth;
  };
  // Over whole bone steps, in each of which the tip advances once.
  const double span = std::floor(0.5 * out.hand.reaction * out.bone_hz) / out.bone_hz, release = out.detected + out.hand.reaction;
  out.speed = (depth_at(release) - depth_at(release - span)) / span;
  out.beyond = simulation.progress().deepest - simulation.approach().thickness;
  out.plunge = simulation.progress().loss ? simulation.progress().loss->plunge : 0.0;
  return out;
}

/// What the tip still advances after the hand begins to release, own derivation. The drill stays on bone, which recedes at `speed` F / push, and
/// comes out of its engagement by the fall of F / K_cut. The hand, at rest at each instant, hangs on the coupling K and on the arm k, whose rest
/// position r follows it with the time constant tau, and rises at twice the feed once the thrust T has ended. With x the way of the hand:
///     F = push - K x = T + k (x - r),   dr/dt = (x - r) / tau.
/// A soft coupling is longer under the same force, so the hand has farther to go, lags behind more, and leaves more force on the drill.
struct After {
  double advance = 0.0;  ///< [m] largest
  double plunge = 0.0;   ///< [m] largest from where bone carries half of the push
};
After after_release(const HandConfig& hand, double coupling, double speed) {
  constexpr double kStep = 1e-5;  // [s]
  const double arm = hand.dynamics.stiffness, slope = -hand.push / hand.release;
  After out;
  double stretch = 0.0, receded = 0.0, force = hand.push, at_half = -1.0;
  for (double t = 0.0; force > 0.0 && t < 10.0; t += kStep) {
    const bool releases = t < hand.release;
    const double tip = receded - (hand.push - force) * hand.cut_compliance;
    if (force < 0.5 * hand.push && at_half < 0.0) at_half = tip;
    out.advance = std::max(out.advance, tip);
    if (at_half >= 0.0) out.plunge = std::max(out.plunge, tip - at_half);
    receded += speed * force / hand.push * kStep;
    const double rest_rises = releases ? stretch / hand.follow_time : 2.0 * hand.feed;
    stretch += (-(releases ? slope : 0.0) / coupling - rest_rises) / (1.0 + arm / coupling) * kStep;
    force = (releases ? hand.push + slope * t : 0.0) + arm * stretch;
  }
  return out;
}

}  // namespace

TEST_CASE("hand: tables and diploe that are felt are no breakthrough, the exit is, and without a plunge") {
  constexpr double kShare = 0.6;
  const Drilled plain = drilled(0.0), felt = drilled(kShare), alone = drilled(kShare, false);
  MESSAGE("through after " << plain.through << " s, felt " << felt.through << " s, by the force alone " << alone.through
                           << " s; beyond bone " << 1e3 * plain.beyond << ", " << 1e3 * felt.beyond << " mm; plunge " << 1e3 * plain.plunge
                           << ", " << 1e3 * felt.plunge << " mm; exit at " << 1e3 * plain.speed << " mm/s");
  // The thrust, and so the feed, is that of the hand, whatever the coupling; while the hand advances the drill has a little less of it.
  CHECK(felt.through < plain.through + 0.5);
  CHECK(felt.detected > felt.through - 0.1);
  CHECK(felt.detected - felt.through < plain.detected - plain.through + 0.05);  // not later
  // After the exit the coupling stays as soft as bone left it: it stiffens only as cutting pays for it (core/contact/felt_hardness.h). It is
  // never softer than on bone of hardness 0. The derivation is continuous, but bone recedes in steps: by up to one of them, at half of the push,
  // where a loss of support begins and where the tip is deepest.
  const After stiff = after_release(plain.hand, plain.coupling, plain.speed);
  const After soft = after_release(plain.hand, plain.coupling * (1.0 - kShare), plain.speed);
  const double step = 0.5 * plain.speed / plain.bone_hz;  // [m]
  MESSAGE("after the release by derivation: advance " << 1e3 * stiff.advance << ", " << 1e3 * soft.advance << " mm; plunge "
                                                      << 1e3 * stiff.plunge << ", " << 1e3 * soft.plunge << " mm");
  CHECK(plain.plunge < stiff.plunge + step);
  CHECK(felt.plunge < soft.plunge + step);
  CHECK(felt.beyond - plain.beyond < soft.advance - stiff.advance + step);
  // Sabotage: such a hand stops in bone.
  CHECK(alone.detected < alone.through - 1.0);
  CHECK(alone.through > felt.through + 2.0);
}

}  // namespace burrhole::test
