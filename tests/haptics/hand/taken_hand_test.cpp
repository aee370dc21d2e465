#include "haptics/hand/taken_hand.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
const Pose kTurned{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};

struct Rig {
  Rig()
      : script(made(SimulatedHand::create(config, kTurned, kPeriod))),
        hand(made(TakenHand::create(script, user, kTurned, kPeriod, goals))) {}
  template <class T>
  static T made(Result<T> result) {
    REQUIRE(result.ok());
    return std::move(result).value();
  }
  /// The force of a stiff surface at the entry.
  static Wrench bone(const HandState& state) {
    const double z = (kTurned.inverse() * state.world_from_hand.translation).z;
    return {kTurned.rotate({0.0, 0.0, z < 0.0 ? -2e4 * z : 0.0}), Vec3(0.0)};
  }
  [[nodiscard]] Vec3 place() { return kTurned.inverse() * hand.read().world_from_hand.translation; }
  void run(int ticks) {
    for (int n = 0; n < ticks; ++n) hand.apply(bone(hand.read()));
  }

  HandConfig config;
  GoalHandConfig user;
  GoalMailbox goals;
  SimulatedHand script;
  TakenHand hand;
};

}  // namespace

TEST_CASE("until it is taken over, the hand is the script's, bit for bit") {
  Rig rig;
  rig.goals.publish({.place = {0.01, 0.0, 0.0}, .spins = false, .ends = true});  // of a user who only looks
  for (int n = 0; n < 3000; ++n) {
    const HandState &mine = rig.hand.read(), &scripts = rig.script.read();
    REQUIRE(mine.world_from_hand.translation == scripts.world_from_hand.translation);
    REQUIRE(mine.velocity == scripts.velocity);
    REQUIRE(mine.thrust == scripts.thrust);
    REQUIRE(mine.phase == scripts.phase);
    REQUIRE(mine.tick == scripts.tick);
    rig.hand.apply(Rig::bone(mine));
    rig.script.apply(Rig::bone(scripts));
  }
  CHECK(rig.hand.read().phase == HandPhase::lean);
}

TEST_CASE("a hand that presses is taken over without a jump, keeps its thrust, and then follows the user") {
  Rig rig;
  rig.run(3000);
  const HandState before = rig.hand.read();
  REQUIRE(before.thrust > 0.9 * rig.config.push);
  const Vec3 at = rig.place();
  const Vec3 goal = at - Vec3(0.0, 0.0, before.thrust / rig.user.dynamics.stiffness);
  rig.goals.publish({.place = goal, .spins = true, .takes_over = true});
  double furthest = 0.0, least = before.thrust, most = before.thrust;
  for (int n = 0; n < 500; ++n) {
    rig.run(1);
    furthest = std::max(furthest, glm::length(rig.place() - at));
    least = std::min(least, rig.hand.read().thrust);
    most = std::max(most, rig.hand.read().thrust);
  }
  // Place, goal and force are in equilibrium on both sides of the change. What the script's arm was still moving, its mass carries on:
  // a speed v of a mass m on bone of stiffness k reaches v sqrt(m / k), and changes the thrust by the arm's stiffness times that.
  const double reach = glm::length(before.velocity) * std::sqrt(rig.user.dynamics.mass / 2e4) + 1e-7;
  CHECK(furthest <= reach + 0.1 / 2e4);  // and a tenth of a newton of the script's thrust that had not settled
  CHECK(most - least <= rig.user.dynamics.stiffness * (reach + 0.1 / 2e4));
  CHECK(rig.hand.read().spin == doctest::Approx(1.0));
  CHECK(rig.hand.read().tick == before.tick + 500);
  rig.goals.publish({.place = {0.0, 0.0, 0.01}, .takes_over = true});
  rig.run(3000);
  CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, 0.01)) < 1e-6);
  CHECK(rig.hand.read().spin == 0.0);
  rig.goals.publish({.place = {0.0, 0.0, 0.01}, .ends = true});  // it is not given back
  rig.run(1);
  CHECK(rig.hand.read().phase == HandPhase::done);
}
