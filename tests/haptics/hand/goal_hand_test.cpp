#include "haptics/hand/goal_hand.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
const Pose kTurned{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};

/// A hand with its mailbox, in an approach frame that is no world frame.
struct Rig {
  explicit Rig(const GoalHandConfig& from = {}) : config(from) {
    auto made = GoalHand::create(config, kTurned, kPeriod, goals);
    REQUIRE(made.ok());
    hand.emplace(std::move(made).value());
  }
  [[nodiscard]] Vec3 place() { return kTurned.inverse() * hand->read().world_from_hand.translation; }
  /// Runs under a force [N] along +z that depends on the height.
  void run(
      int ticks, const std::function<double(double)>& force = [](double) { return 0.0; }) {
    for (int n = 0; n < ticks; ++n) hand->apply({kTurned.rotate({0.0, 0.0, force(place().z)}), Vec3(0.0)});
  }

  GoalHandConfig config;
  GoalMailbox goals;
  std::optional<GoalHand> hand;
};

}  // namespace

TEST_CASE("a user's hand starts at the standoff, at rest, without spin, and stays there") {
  Rig rig;
  CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, rig.config.standoff)) < 1e-15);
  rig.run(500);
  CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, rig.config.standoff)) < 1e-12);
  CHECK(rig.hand->read().spin == 0.0);
  CHECK(rig.hand->read().tick == 500);
  CHECK(rig.hand->read().phase == HandPhase::approach);
}

TEST_CASE("without a force the hand settles at the goal, and never moves faster than its overshoot allows") {
  Rig rig;
  const Vec3 goal(0.02, -0.01, 0.05);
  rig.goals.publish({.place = goal});
  double fastest = 0.0;
  for (int n = 0; n < 2000; ++n) {
    rig.run(1);
    fastest = std::max(fastest, glm::length(rig.hand->read().velocity));
  }
  CHECK(glm::length(rig.place() - goal) < 1e-9);
  // The goal moves at config.speed at most. The mass on its spring answers a ramp with that speed times (1 + exp(-pi z / sqrt(1 - z^2))),
  // z its damping ratio, as a step's answer overshoots.
  const auto& d = rig.config.dynamics;
  const double ratio = d.damping / (2.0 * std::sqrt(d.stiffness * d.mass));
  const double over = std::exp(-std::numbers::pi * ratio / std::sqrt(1.0 - ratio * ratio));
  CHECK(fastest <= rig.config.speed * (1.0 + over));
  CHECK(fastest >= 0.9 * rig.config.speed);
}

TEST_CASE("the thrust on a wall is the stiffness times the way by which the goal lies beyond the drill") {
  Rig rig;
  const double wall = 1e5;  // [N/m]
  const auto bone = [&](double height) { return height < 0.0 ? -wall * height : 0.0; };
  const double deep = 0.004;
  rig.goals.publish({.place = {0.0, 0.0, -deep}});
  rig.run(3000, bone);
  // Two springs in series.
  const double expected = deep * rig.config.dynamics.stiffness * wall / (rig.config.dynamics.stiffness + wall);
  CHECK(rig.hand->read().thrust == doctest::Approx(expected).epsilon(1e-6));
  CHECK(bone(rig.place().z) == doctest::Approx(expected).epsilon(1e-6));
}

TEST_CASE("the thrust ends at the force of the arm, however deep the goal lies") {
  Rig rig;
  const auto bone = [](double height) { return height < 0.0 ? -1e5 * height : 0.0; };
  rig.goals.publish({.place = {0.0, 0.0, -0.5}});
  rig.run(4000, bone);
  CHECK(rig.hand->read().thrust == doctest::Approx(rig.config.push).epsilon(1e-9));
  CHECK(bone(rig.place().z) == doctest::Approx(rig.config.push).epsilon(1e-6));
}

TEST_CASE("bone that vanishes under 28 N lets the hand plunge by its compression, and by no more than that and the overshoot") {
  Rig rig;
  bool gone = false;
  const auto bone = [&](double height) { return !gone && height < 0.0 ? -1e5 * height : 0.0; };
  const double stiffness = rig.config.dynamics.stiffness;
  rig.goals.publish({.place = {0.0, 0.0, -28.0 / stiffness - 28.0 / 1e5}});
  rig.run(3000, bone);
  const double before = rig.place().z;
  gone = true;
  double lowest = before;
  for (int n = 0; n < 1000; ++n) {
    rig.run(1, bone);
    lowest = std::min(lowest, rig.place().z);
  }
  const double compression = 28.0 / stiffness;
  const auto& d = rig.config.dynamics;
  const double ratio = d.damping / (2.0 * std::sqrt(d.stiffness * d.mass));
  const double over = std::exp(-std::numbers::pi * ratio / std::sqrt(1.0 - ratio * ratio));
  CHECK(before - lowest == doctest::Approx(compression * (1.0 + over)).epsilon(0.01));
}

TEST_CASE("the drill leans about its tip, in the direction of both tilts") {
  Rig rig;
  const double right = 0.2, away = -0.1;
  rig.goals.publish({.place = {0.0, 0.0, rig.config.standoff}, .tilt_right = right, .tilt_away = away});
  rig.run(2000);
  const Vec3 shaft = glm::conjugate(kTurned.rotation) * (rig.hand->read().world_from_hand.rotation * Vec3(0.0, 0.0, 1.0));
  const double angle = std::hypot(right, away);
  const Vec3 expected(std::sin(angle) * right / angle, std::sin(angle) * away / angle, std::cos(angle));
  CHECK(glm::length(shaft - expected) < 1e-9);
  CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, rig.config.standoff)) < 1e-12);

  rig.goals.publish({.place = {0.0, 0.0, rig.config.standoff}, .tilt_right = 3.0, .tilt_away = 4.0});
  rig.run(4000);
  const Vec3 far = glm::conjugate(kTurned.rotation) * (rig.hand->read().world_from_hand.rotation * Vec3(0.0, 0.0, 1.0));
  CHECK(std::acos(far.z) == doctest::Approx(rig.config.largest_tilt).epsilon(1e-6));
  CHECK(far.y / far.x == doctest::Approx(4.0 / 3.0).epsilon(1e-6));
}

TEST_CASE("the drive runs up and down in its time") {
  Rig rig;
  rig.goals.publish({.place = {0.0, 0.0, rig.config.standoff}, .spins = true});
  const int ticks = static_cast<int>(std::lround(rig.config.run_up / kPeriod));
  rig.run(ticks / 2);
  CHECK(rig.hand->read().spin == doctest::Approx(0.5).epsilon(0.01));
  rig.run(ticks - ticks / 2 + 1);
  CHECK(rig.hand->read().spin == doctest::Approx(1.0));
  rig.goals.publish({.place = {0.0, 0.0, rig.config.standoff}});
  rig.run(ticks + 1);
  CHECK(rig.hand->read().spin == 0.0);
}

TEST_CASE("a goal that is not finite moves nothing; the end of the run is a phase") {
  Rig rig;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const UserGoal& bad : {UserGoal{.place = {nan, 0.0, 0.0}}, UserGoal{.place = {0.0, 0.0, 0.003}, .tilt_right = nan},
                              UserGoal{.place = {0.0, 0.0, 0.003}, .tilt_away = INFINITY}}) {
    rig.goals.publish(bad);
    rig.run(100);
    CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, rig.config.standoff)) < 1e-12);
  }
  rig.goals.publish({.place = {0.0, 0.0, rig.config.standoff}, .ends = true});
  rig.run(1);
  CHECK(rig.hand->read().phase == HandPhase::done);
}

TEST_CASE("a user's hand refuses values outside their range") {
  GoalMailbox goals;
  const auto refused = [&](auto&& change) {
    GoalHandConfig config;
    change(config);
    const auto made = GoalHand::create(config, kTurned, kPeriod, goals);
    return !made.ok() && made.error().code == ErrorCode::out_of_range;
  };
  CHECK(!refused([](GoalHandConfig&) {}));
  CHECK(refused([](GoalHandConfig& c) { c.push = 0.0; }));
  CHECK(refused([](GoalHandConfig& c) { c.smoothing = -1.0; }));
  CHECK(refused([](GoalHandConfig& c) { c.largest_tilt = 1.6; }));
  CHECK(refused([](GoalHandConfig& c) { c.run_up = NAN; }));
  CHECK(refused([](GoalHandConfig& c) { c.dynamics.mass = 0.0; }));
  CHECK(refused([](GoalHandConfig& c) { c.dynamics.stiffness = 0.0; }));
}
