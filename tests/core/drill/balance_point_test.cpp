// The balance point of a ball against closed forms of bone of simple shape.

#include "core/drill/balance_point.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/voxel/box_parts.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kVoxel = 0.25e-3, kRadius = 1.5e-3;  // [m]
constexpr int kPoints = 1000;

/// Places on a spiral round a ball, equal areas between their heights; the tip at the origin.
Tool ball() {
  Tool out;
  for (int n = 0; n < kPoints; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / kPoints, angle = n * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const Vec3 outward(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
    out.shell.positions.push_back(Vec3(0.0, 0.0, kRadius) + kRadius * outward);
    out.shell.inward_normals.push_back(-outward);
    out.shell.cutting.push_back(1);
  }
  return out;
}

/// Whole voxels of bone; the 0.5 level lies between two centres. @param stretch of the voxels along z.
Voxmap bone_of(const std::function<bool(const Vec3i&)>& solid, double stretch = 1.0) {
  DenseBone dense;
  dense.dims = Vec3i(48, 48, 48);
  dense.bone_from_index = Affine::scaling(kVoxel, Vec3(0.0));
  dense.bone_from_index.linear[2] *= stretch;
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    dense.occupancy.push_back(solid(v) ? 1.0f : 0.0f);
    dense.hardness.push_back(1.0f);
  });
  return voxmap_of(dense);
}
/// Pose whose ball has its middle at `middle` [voxels].
Affine middle_at(const Vec3& middle, double stretch = 1.0) {
  Affine frame = Affine::scaling(kVoxel, Vec3(0.0));
  frame.linear[2] *= stretch;
  const Pose bone_from_tool{.rotation = glm::dquat(1.0, 0.0, 0.0, 0.0), .translation = frame * middle - Vec3(0.0, 0.0, kRadius)};
  return frame.inverse() * Affine::from_pose(bone_from_tool);
}
double angle_between(const Vec3& a, const Vec3& b) { return std::acos(std::min(1.0, glm::dot(a, b) / glm::length(a) / glm::length(b))); }

}  // namespace

TEST_CASE("balance point: on a level face it is straight below, of the cap that meets bone") {
  const Voxmap voxmap = bone_of([](const Vec3i& v) { return v.z <= 20; });  // surface at 20.5
  const BalancePoint law(ball());
  CHECK(law.places() == kPoints);
  for (const double depth : {0.5, 2.0, 4.0}) {  // [voxels] of the ball in bone, of a radius of 6
    const Balance found = law.measure(voxmap.window(), middle_at(Vec3(24.0, 24.0, 20.5 + 6.0 - depth)));
    // A place at height z from the middle is looked at z (1 + 0.5 / 6): it meets bone up to z = -(6 - depth) 12 / 13.
    const double share = 0.5 * (1.0 - (6.0 - depth) / 6.0 * 12.0 / 13.0);
    CHECK(std::abs(static_cast<double>(found.count) - kPoints * share) <= 1.5);
    CHECK(glm::length(found.towards) == doctest::Approx(1.0));
    CHECK(angle_between(found.towards, Vec3(0.0, 0.0, -1.0)) < 0.05);
  }
  CHECK(law.measure(voxmap.window(), middle_at(Vec3(24.0, 24.0, 35.0))).count == 0);
  CHECK(law.measure(voxmap.window(), middle_at(Vec3(24.0, 24.0, 35.0))).towards == Vec3(0.0));
}

TEST_CASE("balance point: bone at a quarter of the ball turns it by 45 degrees") {
  // About 50 places lie at the border of the quarter of 250; if each were on its other side at random, b would move by 0.03 of the radius, of 0.7.
  for (const double stretch : {1.0, 3.0}) {
    const Voxmap voxmap = bone_of([](const Vec3i& v) { return v.x <= 23 && v.z <= 20; }, stretch);
    const Balance found = BalancePoint(ball()).measure(voxmap.window(), middle_at(Vec3(23.5, 24.0, 20.5), stretch));
    CHECK(angle_between(found.towards, Vec3(-1.0, 0.0, -1.0)) < 0.05);
    CHECK(std::abs(static_cast<double>(found.count) - 0.25 * kPoints) < 0.04 * kPoints);
  }
}

TEST_CASE("balance point: bone all round has no direction, and a thin gap in it has little") {
  const BalancePoint law(ball());
  const Voxmap whole = bone_of([](const Vec3i&) { return true; });
  CHECK(glm::length(law.measure(whole.window(), middle_at(Vec3(24.0))).towards) < 0.05);
  // Without the cap above 0.95 of the radius, 2.5 % of the places: b is 0.025 of the radius, half of kLeast.
  const Voxmap open = bone_of([](const Vec3i& v) { return v.z < 24 + 6; });
  const Vec3 towards = law.measure(open.window(), middle_at(Vec3(24.0, 24.0, 23.325))).towards;
  CHECK(towards.z < 0.0);
  CHECK(glm::length(towards) == doctest::Approx(0.5).epsilon(0.2));
}

TEST_CASE("balance point: a bit without cutting places, and one outside the window, meet nothing") {
  const Voxmap voxmap = bone_of([](const Vec3i&) { return true; });
  Tool blunt = ball();
  blunt.shell.cutting.assign(kPoints, 0);
  CHECK(BalancePoint(blunt).measure(voxmap.window(), middle_at(Vec3(24.0))).count == 0);
  CHECK(BalancePoint(ball()).measure(voxmap.window(), middle_at(Vec3(1e7, 0.0, -1e7))).count == 0);
  CHECK(BalancePoint(ball()).measure(voxmap.window(), middle_at(Vec3(NAN))).count == 0);
}
