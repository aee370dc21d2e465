#include "haptics/servo/servo_step.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>

using namespace burrhole;

namespace {

/// A hand that records the force it was given.
class RecordingHand final : public HandSource {
 public:
  [[nodiscard]] const HandState& read() noexcept override { return state_; }
  void drill_at(const Vec3& drill) noexcept override { drill_ = drill; }
  void added_force(const Vec3& added) noexcept override { added_ = added; }
  void apply(const Wrench& on_hand) noexcept override {
    force = on_hand.force;
    drill_before_apply = drill_;
    added_before_apply = added_;
    added_ = Vec3(0.0);
    ++state_.tick;
    state_.world_from_hand.translation.x = static_cast<double>(state_.tick);
  }
  Vec3 force{-1.0};
  Vec3 drill_before_apply{-1.0};
  Vec3 added_before_apply{-1.0};

 private:
  Vec3 drill_{-1.0};
  Vec3 added_{0.0};
  HandState state_;
};

struct Bench {
  RecordingHand hand;
  TripleBuffer<ContactState> contact;
  TripleBuffer<HandState> out;
  ServoStep servo{ServoConfig{.largest_force = 50.0}, hand, contact, out};

  const ServoOutput& tick(const Vec3& force) {
    ContactState state;
    state.on_hand.force = force;
    contact.publish(state);
    return servo();
  }
};

}  // namespace

TEST_CASE("ServoStep: a sound force reaches the hand unchanged, and where the hand was read is published") {
  Bench bench;
  const Vec3 force(1.0, -2.0, 30.0);
  const ServoOutput& output = bench.tick(force);
  CHECK(output.force == force);
  CHECK(bench.hand.force == force);
  CHECK(output.faults == 0);
  CHECK(output.hand.tick == 0);
  CHECK(bench.out.latest().tick == 0);
  static_cast<void>(bench.servo());  // no newer contact: the last force is held
  CHECK(bench.hand.force == force);
  CHECK(bench.out.latest().tick == 1);
  CHECK(bench.out.latest().world_from_hand.translation.x == 1.0);
}

TEST_CASE("ServoStep: the hand receives the place of the drill in the newest contact result before the force, and none before the first") {
  Bench bench;
  bench.tick(Vec3(0.0));  // number 0: there was no contact yet
  CHECK(bench.hand.drill_before_apply == Vec3(-1.0));
  for (std::uint64_t n = 1; n < 4; ++n) {
    ContactState state;
    state.number = n;
    state.world_from_tool.translation = {1.0, 2.0, static_cast<double>(n)};
    bench.contact.publish(state);
    bench.servo();
    CHECK(bench.hand.drill_before_apply == Vec3(1.0, 2.0, static_cast<double>(n)));
    // Of a bone that has moved, as it would be with the bone at rest.
    state.bone.world_from_rest.translation = {0.0, 0.0, -1.0};
    bench.contact.publish(state);
    bench.servo();
    CHECK(bench.hand.drill_before_apply == Vec3(1.0, 2.0, static_cast<double>(n) + 1.0));
  }
}

TEST_CASE("ServoStep: the hand receives what effects add to its force, as far as it is shown, and nothing where nothing is added") {
  RecordingHand hand;
  TripleBuffer<ContactState> contact;
  TripleBuffer<HandState> out;
  ServoStep servo{ServoConfig{.soft_start = 0.004}, hand, contact, out};
  const Vec3 added(0.0, 1.0, 4.0);
  for (std::uint64_t n = 1; n < 8; ++n) {
    ContactState state;
    state.number = n;
    state.on_hand.force = {0.0, 0.0, 20.0};
    contact.publish(state);
    servo.sense();
    const ServoOutput& shown = servo.act(added);
    CHECK(hand.added_before_apply == added * shown.gain);  // the soft start shows 1/4, 2/4, 3/4 and all of the force
    CHECK(glm::length(hand.force - hand.added_before_apply - state.on_hand.force * shown.gain) < 1e-14);
    CHECK(shown.gain == doctest::Approx(std::min(1.0, 0.25 * static_cast<double>(n))));
  }
  servo();
  CHECK(hand.added_before_apply == Vec3(0.0));
}

TEST_CASE(
    "ServoStep: of a force that a limit shortens or delays the hand receives the part that effects added, and the rest is contact's") {
  struct Shown {
    Vec3 contact{0.0}, added{0.0}, reported{0.0}, force{0.0};
  };
  const auto run = [](const ServoConfig& config, int ticks, const std::function<void(int, Shown&)>& wanted,
                      const std::function<void(int, const Shown&)>& check) {
    RecordingHand hand;
    TripleBuffer<ContactState> contact;
    TripleBuffer<HandState> out;
    ServoStep servo{config, hand, contact, out};
    for (int n = 0; n < ticks; ++n) {
      Shown now;
      wanted(n, now);
      ContactState state;
      state.number = static_cast<std::uint64_t>(n) + 1;
      state.on_hand.force = now.contact;
      contact.publish(state);
      servo.sense();
      servo.act(now.added);
      now.reported = hand.added_before_apply;
      now.force = hand.force;
      check(n, now);
      if (n == 60 && config.soft_start > 0.0) servo.restart();
    }
  };
  // A cap of 10 N on 12 and 4 N: of each five eighths.
  run(
      {.largest_force = 10.0, .soft_start = 0.0}, 5,
      [](int, Shown& now) {
        now = {{0.0, 0.0, 12.0}, {0.0, 0.0, 4.0}, {}, {}};
      },
      [](int, const Shown& now) {
        CHECK(glm::length(now.reported - 0.625 * now.added) < 1e-14);
        CHECK(glm::length(now.force - now.reported - 0.625 * now.contact) < 1e-14);
        CHECK(glm::length(now.force - now.added - 0.625 * now.contact) > 1.0);  // sabotage: what was added before the cap
      });
  // A slew limit of 1 N a tick: effects push across a contact that is steady; its part of the force does not change as theirs comes and goes.
  run(
      {.largest_slew = 1000.0, .soft_start = 0.0}, 60,
      [](int n, Shown& now) {
        now = {{2.0, 0.0, 0.0}, {0.0, n >= 10 && n < 30 ? 4.0 : 0.0, 0.0}, {}, {}};
      },
      [](int n, const Shown& now) {
        if (n < 5) return;
        const double part = n < 10 ? 0.0 : n < 30 ? std::min(4.0, n - 9.0) : std::max(0.0, 33.0 - n);
        CHECK(glm::length(now.reported - Vec3(0.0, part, 0.0)) < 1e-12);
        CHECK(glm::length(now.force - now.reported - now.contact) < 1e-12);
      });
  // With every limit, two parts that stay in proportion are shown in proportion, through a restart too.
  bool limited = false;
  run(
      {.largest_force = 10.0, .largest_slew = 400.0, .soft_start = 0.02}, 120,
      [](int n, Shown& now) {
        const Vec3 all = 16.0 * Vec3(std::sin(0.1 * n), std::cos(0.07 * n), 1.0);
        now = {0.75 * all, 0.25 * all, {}, {}};
      },
      [&limited](int, const Shown& now) {
        CHECK(glm::length(now.reported - 0.25 * now.force) < 1e-13);
        limited = limited || glm::length(now.force - now.contact - now.added) > 1.0;
      });
  CHECK(limited);
}

TEST_CASE("ServoStep: a force that is not finite in any component becomes zero, at once and for good") {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Bench bench;
      static_cast<void>(bench.tick({0.0, 0.0, 5.0}));
      Vec3 force(1.0, 2.0, 3.0);
      force[axis] = bad;
      CHECK(bench.tick(force).force == Vec3(0.0));
      CHECK(bench.hand.force == Vec3(0.0));
      CHECK((bench.servo.faults() & kServoForceNotFinite) != 0);
      CHECK(bench.tick({0.0, 0.0, 5.0}).force == Vec3(0.0));
      CHECK(bench.hand.force == Vec3(0.0));
      CHECK((bench.servo.faults() & kServoForceNotFinite) != 0);
    }
}

TEST_CASE("ServoStep: the cap limits the magnitude, keeps the direction, and sets its flag") {
  Bench bench;
  const Vec3 force = 1000.0 * glm::normalize(Vec3(1.0, -2.0, 2.0));
  const ServoOutput& output = bench.tick(force);
  CHECK(std::abs(glm::length(output.force) - 50.0) < 50.0 * 1e-15);
  CHECK(glm::length(glm::cross(output.force, force)) < 1e-10);
  CHECK(glm::dot(output.force, force) > 0.0);
  CHECK(output.faults == kServoForceCapped);
  CHECK(bench.hand.force == output.force);
  CHECK(bench.tick({0.0, 0.0, 49.9}).force == Vec3(0.0, 0.0, 49.9));  // not latched as a limit
}

TEST_CASE("ServoStep: a finite force whose square overflows is capped, never turned into a direction of its own") {
  Bench bench;
  const Vec3 applied = bench.tick({0.0, 0.0, 1e200}).force;
  CHECK(is_finite(applied));
  CHECK(glm::length(applied) <= 50.0 * (1.0 + 1e-15));
}

TEST_CASE("ServoStep: the cap's own flag says the tick that it limited") {
  Bench bench;
  CHECK((bench.tick({0.0, 0.0, 60.0}).faults & kServoForceCapped) != 0);
  CHECK((bench.tick({0.0, 0.0, 10.0}).faults & kServoForceCapped) == 0);
}
