#include "haptics/servo/local_tool.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/base/rotation.h"
#include "haptics/servo/plane_loads.h"
#include "tests/support/local_states.h"

using namespace burrhole;
using test::make_plane;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
const Vec3 kUp(0.0, 0.0, 1.0);

Pose pose_at(const Vec3& position) {
  Pose pose;
  pose.translation = position;
  return pose;
}

Wrench step_at(LocalTool& tool, const ContactState& state, const Vec3& position) {
  return tool.step(state, pose_at(position), Vec3(0.0), kPeriod);
}

}  // namespace

TEST_CASE("LocalTool: pressed on a plane it is coupling, bone and engagement in series, and none is free") {
  for (const bool cutting : {false, true}) {
    HoldPlane plane = make_plane(kUp, 0.0, 2e-5, 1);
    plane.cutting = cutting;
    const ContactState state = test::coupled_state({plane}, 5000.0);
    LocalTool tool;
    tool.renew(state, 1.0);
    const double compliance = 1.0 / 5000.0 + 2e-5 + (cutting ? 1e-5 : 0.0);
    const Wrench found = step_at(tool, state, Vec3(1e-3, 0.0, -1e-3));
    CHECK(std::abs(found.force.z - 1e-3 / compliance) < 1e-9);
    CHECK(found.force.x == 0.0);  // frictionless
    CHECK(std::abs(tool.world_from_tool().translation.x - 1e-3) < 1e-15);
    CHECK(step_at(tool, state, Vec3(0.0, 0.0, 1e-3)).force == Vec3(0.0));  // and it lets go
  }
}

TEST_CASE("LocalTool: pressed at a lever the turn gives way as its spring allows, and the hand feels the torque") {
  HoldPlane plane = make_plane(kUp, 0.0, 1e-9, 1);
  plane.arm = Vec3(0.05, 0.0, 0.0);
  const ContactState state = test::coupled_state({plane}, 5000.0);
  LocalTool tool;
  tool.renew(state, 1.0);
  const double compliance = 1.0 / 5000.0 + 0.05 * 0.05 / 20.0 + 1e-9;
  const Wrench found = step_at(tool, state, Vec3(0.0, 0.0, -1e-3));
  CHECK(std::abs(found.force.z - 1e-3 / compliance) < 1e-9);
  CHECK(std::abs(found.torque.y + 0.05 * found.force.z) < 1e-12);
  CHECK(std::abs(rotation_vector(tool.world_from_tool().rotation).y + 0.05 * found.force.z / 20.0) < 1e-9);
}

TEST_CASE("LocalTool: a hand that turns presses a lever onto a plane not touched before") {
  HoldPlane plane = make_plane(kUp, 1e-4, 1e-9, 1);
  plane.arm = Vec3(0.05, 0.0, 0.0);
  const ContactState state = test::coupled_state({plane}, 5000.0);
  LocalTool tool;
  tool.renew(state, 1.0);
  Pose hand;
  hand.rotation = rotation_of(Vec3(0.0, 0.01, 0.0));  // the lever goes down by 0.5 mm
  const Wrench found = tool.step(state, hand, Vec3(0.0), kPeriod);
  CHECK(std::abs(found.force.z - 4e-4 / (1.0 / 5000.0 + 0.05 * 0.05 / 20.0 + 1e-9)) < 1e-8);
  hand.rotation = rotation_of(Vec3(0.0, -0.01, 0.0));  // sabotage: the other way it touches nothing
  CHECK(tool.step(state, hand, Vec3(0.0), kPeriod).force == Vec3(0.0));
}

TEST_CASE("LocalTool: a bilateral plane exerts attractive force, any other only repulsive") {
  for (const bool both_ways : {false, true}) {
    HoldPlane plane = make_plane(Vec3(1.0, 0.0, 0.0), 0.0, 1e-4, 1);
    plane.both_ways = both_ways;
    const ContactState state = test::coupled_state({plane}, 1e4);
    LocalTool tool;
    tool.renew(state, 1.0);
    const double pulled = step_at(tool, state, Vec3(1e-3, 0.0, 0.0)).force.x;
    CHECK(std::abs(pulled - (both_ways ? -5.0 : 0.0)) < 1e-9);  // 1 mm over 1e-4 + 1e-4 m/N
    CHECK(std::abs(step_at(tool, state, Vec3(-1e-3, 0.0, 0.0)).force.x - 5.0) < 1e-9);
  }
}

TEST_CASE("LocalTool: the damper takes the hand's speed where the tool is held, and relaxes to the spring's force at rest") {
  const ContactState state = test::coupled_state({make_plane(kUp, 0.0, 1e-12, 1)}, 5000.0, 20.0);
  LocalTool tool;
  tool.renew(state, 1.0);
  const Wrench moving = tool.step(state, pose_at(-1e-3 * kUp), Vec3(0.0, 0.0, -0.05), kPeriod);
  CHECK(std::abs(moving.force.z - (5000.0 * 1e-3 + 20.0 * 0.05)) < 1e-6);
  for (int n = 0; n < 50; ++n) static_cast<void>(step_at(tool, state, -1e-3 * kUp));
  CHECK(std::abs(step_at(tool, state, -1e-3 * kUp).force.z - 5.0) < 1e-6);
}

TEST_CASE("LocalTool: a new state with the same contact changes nothing, and one that forgets where the tool is jumps") {
  const auto run = [](bool renew, bool forget) {
    ContactState state =
        test::coupled_state({make_plane(kUp, 0.0, 1e-7, 1), make_plane(glm::normalize(Vec3(1.0, 0.0, 1.0)), 1e-4, 1e-7, 2)}, 5000.0, 20.0);
    LocalTool tool;
    tool.renew(state, 2e-3);
    double sum = 0.0;
    for (int n = 0; n < 40; ++n) {
      if (n % 10 == 5 && forget) tool.clear();
      if (n % 10 == 5 && renew) tool.renew(state, 2e-3);
      const Vec3 hand(-1e-5 * n, 0.0, -2e-5 * n);
      sum += (n + 1.0) * glm::dot(tool.step(state, pose_at(hand), Vec3(-0.01, 0.0, -0.02), kPeriod).force, Vec3(1.0, 2.0, 3.0));
    }
    return sum;
  };
  CHECK(std::abs(run(true, false) / run(false, false) - 1.0) < 1e-12);  // the solver starts from the same loads: rounding
  CHECK(std::abs(run(true, true) / run(false, false) - 1.0) > 1e-4);
}

TEST_CASE("LocalTool: goes on no further than max_distance from the tool of a new state") {
  ContactState state = test::coupled_state({}, 5000.0);
  state.local.coupling_damping = 0.0;
  LocalTool tool;
  tool.renew(state, 1e-3);
  static_cast<void>(step_at(tool, state, Vec3(0.5, 0.0, 0.0)));
  CHECK(std::abs(tool.world_from_tool().translation.x - 0.5) < 1e-12);
  tool.renew(state, 1e-3);
  CHECK(std::abs(tool.world_from_tool().translation.x - 1e-3) < 1e-15);
}

TEST_CASE(
    "PlaneLoads: the slopes of a constrained tool are those of the local tool at rest, found by moving it, with levers, cutting and "
    "springs") {
  int corners = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    ContactState state = test::coupled_state({}, 5000.0);
    for (std::uint32_t n = 0; n < 5; ++n) {
      const Vec3 normal = glm::normalize(kUp + 0.6 * test::random_vector(seed, n));
      HoldPlane plane = make_plane(normal, 0.0, 1e-5, n);
      plane.arm = 0.02 * test::random_vector(seed + 100, n);
      plane.cutting = n % 2 == 0;
      plane.both_ways = n == 3;
      state.local.planes[state.local.count++] = plane;
    }
    // Pressed well in: the loads at rest, by the local tool itself.
    const Vec3 pressed(0.0, 0.0, -2e-3);
    LocalTool tool;
    tool.renew(state, 1.0);
    const auto force_at = [&](const Vec3& moved) { return step_at(tool, state, pressed + moved).force; };
    static_cast<void>(force_at(Vec3(0.0)));
    LocalContact loaded = state.local;
    loaded.count = 0;
    for (HoldPlane plane : state.local.list()) {
      // What each carries is not told; a plane belongs to those in load if leaving it out changes the force.
      ContactState without = state;
      without.local.count = 0;
      for (const HoldPlane& other : state.local.list())
        if (other.point != plane.point) without.local.planes[without.local.count++] = other;
      LocalTool twin;
      twin.renew(without, 1.0);
      plane.force = glm::length(step_at(twin, without, pressed).force - force_at(Vec3(0.0))) > 1e-9 ? 1.0 : 0.0;
      loaded.planes[loaded.count++] = plane;
    }
    PlaneLoads loads;
    loads.set_coupled(loaded);
    const Mat3 gradient = loads.gradient();
    constexpr double kStep = 1e-6;  // [m] the problem is piecewise linear: no error of order, only rounding of 10 N over it
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 moved(0.0);
      moved[axis] = kStep;
      const Vec3 ahead = (force_at(moved) - force_at(Vec3(0.0))) / kStep, behind = (force_at(Vec3(0.0)) - force_at(-moved)) / kStep;
      if (glm::length(ahead - behind) > 1e-2) {  // a plane begins or ends to carry just there
        ++corners;
        continue;
      }
      const Vec3 measured = 0.5 * (ahead + behind);
      CHECK(glm::length(measured - gradient[axis]) < 1e-3);  // [N/m] of 5000; 1e-9 N over 2e-6 m
    }
    CHECK(glm::length(gradient[2]) > 100.0);
  }
  CHECK(corners <= 1);  // of 60 directions
}
