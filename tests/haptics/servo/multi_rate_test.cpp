#include "haptics/servo/multi_rate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/local_states.h"

using namespace burrhole;
using test::make_plane;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
const Vec3 kUp(0.0, 0.0, 1.0);

HandState at(const Vec3& position) {
  HandState hand;
  hand.world_from_hand.translation = position;
  return hand;
}

MultiRateConfig config_of(MultiRateScheme scheme, int contact_ticks = 10, double max_distance = 1.0) {
  return {.scheme = scheme, .contact_ticks = contact_ticks, .max_distance = max_distance};
}

/// Random planes round a hand, some pressed and some near.
ContactState random_penalty(std::uint64_t seed, std::uint32_t count) {
  ContactState state = test::penalty_state({});
  for (std::uint32_t n = 0; n < count; ++n) {
    const double yield = 1e-3 * (0.1 + uniform01(seed + 1, n));
    state.local.planes[n] = make_plane(test::random_unit(seed, n), 1e-3 * uniform11(seed + 2, n), yield, n);
    state.local.planes[n].arm = 0.01 * test::random_vector(seed + 3, n);
  }
  state.local.count = count;
  state.on_hand.force = test::penalty_force(state.local, Vec3(0.0));
  state.world_from_hand.translation = test::random_vector(seed + 4, 0);
  return state;
}

}  // namespace

TEST_CASE("MultiRate: linear goes from the force shown to the latest in N equal steps, ends on it to the bit, and stays") {
  MultiRate rate(config_of(MultiRateScheme::linear, 4));
  ContactState state;
  const auto shown = [&] { return rate(state, at(Vec3(0.0)), kPeriod).force.z; };
  CHECK(shown() == 0.0);  // no evaluation yet
  state.number = 1;
  state.on_hand.force.z = 4.0;
  for (const double expected : {1.0, 2.0, 3.0, 4.0, 4.0}) CHECK(shown() == expected);
  state.number = 2;
  state.on_hand.force.z = 0.1;
  CHECK(shown() == 4.0 + (0.1 - 4.0) * 0.25);
  static_cast<void>(shown());
  state.number = 3;  // early: goes on from what is shown
  const double before = 4.0 + (0.1 - 4.0) * 0.5;
  state.on_hand.force.z = 7.0 / 3.0;
  CHECK(shown() == before + (7.0 / 3.0 - before) * 0.25);
  for (int n = 0; n < 3; ++n) static_cast<void>(shown());
  CHECK(shown() == 7.0 / 3.0);
}

TEST_CASE("MultiRate: hold is the latest force whatever the hand does") {
  MultiRate rate(config_of(MultiRateScheme::hold));
  ContactState state = random_penalty(1, 5);
  for (std::uint64_t n = 0; n < 10; ++n) CHECK(rate(state, at(test::random_vector(9, n)), kPeriod).force == state.on_hand.force);
}

TEST_CASE(
    "MultiRate: at the sample gradient and planes give the contact's own force to the bit, also where planes do not contain all of it") {
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    for (std::uint64_t seed = 100; seed < 120; ++seed) {
      MultiRate rate(config_of(scheme));
      ContactState state = random_penalty(seed, 1 + static_cast<std::uint32_t>(seed % kMaxLocalPlanes));
      if (state.on_hand.force == Vec3(0.0)) continue;
      state.on_hand.torque = test::random_vector(seed, 7);
      if (seed % 2 == 0) state.on_hand.force *= 0.37;  // a model's cap
      const Wrench found = rate(state, at(state.world_from_hand.translation), kPeriod);
      CAPTURE(seed);
      CHECK(found.force == state.on_hand.force);
      CHECK(found.torque == state.on_hand.torque);
    }
  // The gradient of a held tool too; its `planes` have a memory, the local tool.
  MultiRate rate(config_of(MultiRateScheme::gradient));
  HoldPlane floor = make_plane(kUp, -1e-6, 1e-7, 1), wall = make_plane(glm::normalize(Vec3(1.0, 0.2, 0.0)), -2e-6, 1e-7, 2);
  floor.force = 3.1;
  wall.force = 0.7;
  const ContactState state = test::coupled_state({floor, wall});
  CHECK(rate(state, at(Vec3(0.0)), kPeriod).force == state.on_hand.force);
}

TEST_CASE("MultiRate: planes of a penalty model is the plain sum over all its planes, gradient that over the pressed ones") {
  double worst = 0.0, foreseen = 0.0;
  for (std::uint64_t seed = 200; seed < 240; ++seed) {
    const ContactState state = random_penalty(seed, 12);
    ContactState pressed = state;
    pressed.local.count = 0;
    for (const HoldPlane& plane : state.local.list())
      if (plane.gap < 0.0) pressed.local.planes[pressed.local.count++] = plane;
    if (pressed.local.count == 0) continue;
    MultiRate planes(config_of(MultiRateScheme::planes)), gradient(config_of(MultiRateScheme::gradient));
    for (std::uint64_t n = 0; n < 20; ++n) {
      const Vec3 moved = 5e-4 * test::random_vector(seed, 1000 + n);
      const HandState hand = at(state.world_from_hand.translation + moved);
      const Vec3 all = planes(state, hand, kPeriod).force, some = gradient(state, hand, kPeriod).force;
      worst = std::max({worst, glm::length(all - test::penalty_force(state.local, moved)),
                        glm::length(some - test::penalty_force(pressed.local, moved))});
      foreseen = std::max(foreseen, glm::length(all - some));
    }
  }
  // Forces of up to 1e2 N, positions of 1 m against moves of 1e-4 m in stiffness 1e4 N/m: rounding of 1e-16 m times 1e5.
  CHECK(worst < 1e-9);
  CHECK(foreseen > 0.1);  // sabotage: the pressed ones alone are another force
}

TEST_CASE("MultiRate: while all pressed planes stay pressed gradient is eq. 3 with the force's gradient") {
  MultiRate rate(config_of(MultiRateScheme::gradient));
  const ContactState state =
      test::penalty_state({make_plane(kUp, -2e-3, 1e-4, 1), make_plane(glm::normalize(Vec3(1, 1, 1)), -2e-3, 3e-4, 2)});
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 moved = 1e-3 * test::random_vector(3, n);
    const Vec3 expected = state.on_hand.force + state.force_gradient * moved;
    CHECK(glm::length(rate(state, at(moved), kPeriod).force - expected) < 1e-12);              // rounding of 20 N
    CHECK(glm::length(state.on_hand.force - state.force_gradient * moved - expected) > 1e-3);  // sabotage: the sign of the gradient
  }
}

TEST_CASE("MultiRate: no attractive force on a hand that leaves bone; eq. 3 as printed has one") {
  double printed_pull = 0.0;
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    for (const LocalKind kind : {LocalKind::none, LocalKind::penalty, LocalKind::coupled}) {
      CAPTURE(std::string(name_of(scheme)));
      CAPTURE(static_cast<int>(kind));
      HoldPlane plane = make_plane(kUp, -1e-4, 1e-4, 1);
      ContactState state = test::penalty_state({plane});
      if (kind == LocalKind::coupled) {
        plane.force = 1.0;
        plane.gap = 0.0;
        plane.yield = 1e-8;
        state = test::coupled_state({plane}, 1e4, 10.0);
        state.force_gradient[2][2] = -1e4;
        state.world_from_tool.translation.z = 1e-4;
      }
      if (kind == LocalKind::none) state.local = {};
      MultiRate rate(config_of(scheme));
      for (int n = 0; n <= 20; ++n) {
        HandState hand = at(Vec3(1e-5 * n, 0.0, 2e-5 * n));
        hand.velocity = Vec3(0.01, 0.0, 0.02);
        const double along = rate(state, hand, kPeriod).force.z;
        CHECK(along >= 0.0);
        if (n > 6) CHECK(along == 0.0);  // a height of 1e-4 m is off the plane; at n = 5 rounding decides
        printed_pull = std::min(printed_pull, state.on_hand.force.z + state.force_gradient[2][2] * hand.world_from_hand.translation.z);
      }
    }
  CHECK(printed_pull < -1.0);
}

TEST_CASE("MultiRate: a plane not touched at the sample is felt before the next state by planes, and by nothing else") {
  for (const LocalKind kind : {LocalKind::penalty, LocalKind::coupled}) {
    const HoldPlane near = make_plane(kUp, 2e-4, 1e-4, 3);
    const ContactState state = kind == LocalKind::penalty ? test::penalty_state({near}) : test::coupled_state({near}, 1e4);
    const HandState hand = at(Vec3(0.0, 0.0, -5e-4));
    MultiRate planes(config_of(MultiRateScheme::planes)), gradient(config_of(MultiRateScheme::gradient)),
        hold(config_of(MultiRateScheme::hold));
    // 0.3 mm into a give of 1e-4 m/N; the coupling's own 1e-4 m/N doubles it.
    const double expected = kind == LocalKind::penalty ? 3.0 : 1.5;
    CHECK(std::abs(planes(state, hand, kPeriod).force.z - expected) < 1e-9);
    CHECK(gradient(state, hand, kPeriod).force == Vec3(0.0));
    CHECK(hold(state, hand, kPeriod).force == Vec3(0.0));
  }
}

TEST_CASE("MultiRate: a hand further from the sample than max_distance is felt as at that distance") {
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes}) {
    ContactState state = test::penalty_state({make_plane(kUp, -1e-4, 1e-4, 1)});
    MultiRate rate(config_of(scheme, 10, 2e-3)), unbounded(config_of(scheme, 10, std::numeric_limits<double>::infinity()));
    CHECK(std::abs(rate(state, at(-1.0 * kUp), kPeriod).force.z - 21.0) < 1e-9);
    CHECK(std::abs(unbounded(state, at(-1.0 * kUp), kPeriod).force.z - 10001.0) < 1e-6);  // sabotage
  }
}

namespace {

/// A ball of bone felt by a ball of a tool, radii together kRho, with the penalty law; told as the one plane between them.
constexpr double kRho = 6e-3, kStiffness = 5000.0;  // [m], [N/m]

Vec3 ball_force(const Vec3& x) {
  const double distance = glm::length(x);
  return distance < kRho ? x / distance * (kStiffness * (kRho - distance)) : Vec3(0.0);
}

ContactState ball_state(const Vec3& x, std::uint64_t number) {
  const double distance = glm::length(x);
  ContactState state = test::penalty_state({make_plane(x / distance, distance - kRho, 1.0 / kStiffness, 1)});
  state.on_hand.force = ball_force(x);
  state.world_from_hand.translation = x;
  state.number = number;
  return state;
}

struct BallRun {
  double worst_excess = -1.0;  ///< [N] of the error over its bound
  double worst_step = 0.0;     ///< [N] change of force in a tick
  double largest = 0.0;        ///< [N] force
  double pull = 0.0;           ///< [N] most negative component away from the ball
};

/// A stroke over the ball: pressed 0.4 mm, sliding on, off at its flank. `stale`: planes are those of so many states ago.
BallRun stroke(MultiRateScheme scheme, int stale) {
  constexpr int kEvery = 20;
  constexpr double kSpeed = 0.05;  // [m/s] a fast stroke: 1 mm between two states
  MultiRate rate(config_of(scheme, kEvery));
  std::vector<ContactState> states;
  BallRun out;
  Vec3 before(0.0);
  for (int n = 0; n < 200; ++n) {
    const Vec3 x(-4e-3 + kSpeed * kPeriod * n, 1e-3, kRho - 0.4e-3);
    if (n % kEvery == 0) states.push_back(ball_state(x, states.size() + 1));
    const auto used = std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(states.size()) - 1 - stale);
    const Vec3 force = rate(states[static_cast<std::size_t>(used)], at(x), kPeriod).force;
    const double moved = glm::length(x - states.back().world_from_hand.translation);
    const double size = glm::length(ball_force(x)), distance = glm::length(x);
    // The plane leaves the ball by moved^2 / 2 rho at most, and its normal turns by moved / rho under what it carries (either's, the
    // larger).
    const double bound = kStiffness * moved * moved / (2.0 * distance) + std::max(size, glm::length(force)) * moved / (kRho - 1e-3) + 1e-12;
    out.worst_excess = std::max(out.worst_excess, glm::length(force - ball_force(x)) - bound);
    out.pull = std::min(out.pull, glm::dot(force, x / distance));
    out.largest = std::max(out.largest, glm::length(force));
    if (n > 0) out.worst_step = std::max(out.worst_step, glm::length(force - before));
    before = force;
  }
  return out;
}

}  // namespace

TEST_CASE(
    "MultiRate: on convex bone gradient and planes stay within second order of the true force, without attractive force, smoother than "
    "hold") {
  const BallRun held = stroke(MultiRateScheme::hold, 0), planes = stroke(MultiRateScheme::planes, 0);
  MESSAGE("largest change of force in a tick: hold " << held.worst_step << " N, planes " << planes.worst_step << " N, gradient "
                                                     << stroke(MultiRateScheme::gradient, 0).worst_step << " N");
  CHECK(planes.worst_excess <= 0.0);
  CHECK(planes.pull >= 0.0);
  CHECK(stroke(MultiRateScheme::gradient, 0).pull >= 0.0);
  // A tick moves 0.05 mm; a new state corrects what second order left over 1 mm.
  CHECK(planes.worst_step < kStiffness * 0.05e-3 + kStiffness * 1e-6 / (2.0 * (kRho - 1e-3)) + planes.largest / (kRho - 1e-3) * 1e-3);
  CHECK(planes.worst_step < 0.6 * held.worst_step);
  // Sabotage: planes of one state ago leave the bound.
  CHECK(stroke(MultiRateScheme::planes, 1).worst_excess > 0.1);
  CHECK(held.worst_excess > 0.1);
}

TEST_CASE("MultiRate: within a state the force changes no faster than all planes together are stiff") {
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    for (std::uint64_t seed = 300; seed < 320; ++seed) {
      const ContactState state = random_penalty(seed, 8);
      double stiffness = 0.0;
      for (const HoldPlane& plane : state.local.list()) stiffness += 1.0 / plane.yield;
      MultiRate rate(config_of(scheme));
      Vec3 x = state.world_from_hand.translation, before = rate(state, at(x), kPeriod).force;
      for (std::uint64_t n = 0; n < 200; ++n) {
        const Vec3 step = 2e-5 * test::random_vector(seed, 500 + n);
        x += step;
        const Vec3 now = rate(state, at(x), kPeriod).force;
        REQUIRE(glm::length(now - before) <= stiffness * glm::length(step) + 1e-9);  // rounding of positions of 1 m
        before = now;
      }
    }
}
