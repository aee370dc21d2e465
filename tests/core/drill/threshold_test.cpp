// Law `threshold` against closed forms: the area and the stress under a ball in a plane, the volume of a cap by count, nothing below the
// strength, and no loss of bone in the account.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/drill/threshold_removal.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdge = 0.25e-3, kRadius = 3e-3;  // [m]

ErosionPoints ball_points() { return lattice(Ball{kRadius}, kEdge / 2.0, 1.0f); }

ErosionConfig law(double strength = 1.0, double reach = 0.75) {
  return {.law = ErosionLaw::threshold, .threshold = {.ultimate_strength = strength, .reach = reach, .bearing_share = 0.5}};
}

/// A block whose top face, at half a voxel above the last layer, is far wider than the ball.
Voxmap plane() { return Block{.dims = Vec3i(64, 64, 40), .pitch = kEdge}.make(); }
constexpr double kTop = 39.5;  // [voxels]

/// The ball `depth` [m] deep in the plane, beside the grid's symmetry planes.
Affine pressed(double depth) { return upright_pose(kEdge, Vec3(31.37, 32.21, kTop - depth / kEdge)); }

double cap_volume(double radius, double height) { return kPi * height * height * (radius - height / 3.0); }

/// Voxels of the plane with a centre inside a ball, counted plainly.
std::uint64_t count_inside(const Affine& pose, double radius) {
  const Vec3 centre = pose * Vec3(0.0, 0.0, kRadius);
  std::uint64_t out = 0;
  for_each_voxel({Vec3i(0), Vec3i(64, 64, 40)}, [&](const Vec3i& v) { out += glm::length(Vec3(v) - centre) * kEdge <= radius ? 1 : 0; });
  return out;
}

}  // namespace

TEST_CASE("threshold: the ball of a round bit has its radius and centre, of a flat cylinder its width") {
  const CuttingBall ball = cutting_ball(ball_points());
  CHECK(std::abs(ball.radius - kRadius) < kEdge / 2.0);  // the lattice's pitch
  CHECK(std::abs(ball.centre.z - ball.radius) < 1e-12);
  CHECK(std::abs(cutting_ball(lattice(Cylinder{2e-3, 5e-3}, kEdge / 2.0, 1.0f)).radius - 2e-3) < kEdge / 2.0);
  CHECK(cutting_ball(lattice(Ball{kRadius}, kEdge / 2.0, 0.0f)).radius == 0.0);
}

TEST_CASE("threshold: the stress is the force over the share of the cap's projected area, along the reaction") {
  for (const double depth : {0.5e-3, 1.0e-3, 2.0e-3}) {
    Voxmap bone = plane();
    Erosion erosion = make_erosion(ball_points(), law(1e30));
    const Affine pose = pressed(depth);
    const double stress = erosion.step(bone, {pose, pose}, {.spin = 100.0, .force = 10.0}, 1e-3).stress;
    // The lowest layer of centres that counts lies at most an edge below the face, so the disc is that of a depth between depth - edge
    // and depth; a raster counts a disc within a ring of half an edge.
    const double radius = cutting_ball(ball_points()).radius;
    const auto disc = [&](double d) { return std::sqrt(std::max(0.0, d * (2.0 * radius - d))); };
    const double least = kPi * std::pow(disc(depth - kEdge) - 0.5 * kEdge, 2), most = kPi * std::pow(disc(depth) + 0.5 * kEdge, 2);
    CHECK(stress > 10.0 / (0.5 * most));
    CHECK(stress < 10.0 / (0.5 * least));
  }
}

TEST_CASE("threshold: exactly the voxels within the reach of the ball are removed, and their volume is that of a cap") {
  const double reach = 0.75 * cutting_ball(ball_points()).radius;
  for (const double depth : {1.5e-3, 2.5e-3}) {
    Voxmap bone = plane();
    Erosion erosion = make_erosion(ball_points(), law());
    const Affine pose = pressed(depth);
    const ErosionOutcome out = erosion.step(bone, {pose, pose}, {.spin = 100.0, .force = 10.0}, 1e-3);
    const std::uint64_t expected =
        count_inside(Affine{pose.linear, pose.offset + pose.linear * Vec3(0.0, 0.0, cutting_ball(ball_points()).radius - kRadius)}, reach);
    CHECK(out.touched == expected);
    CHECK(std::abs(out.removed_mass - static_cast<double>(expected) * std::pow(kEdge, 3)) < 1e-9 * out.removed_mass);
    // The count of centres in a solid differs from its volume by less than half a layer on its surface, mostly cancelling: a quarter of
    // that is allowed.
    const double height = reach - (cutting_ball(ball_points()).radius - depth),
                 area = 2.0 * kPi * reach * height + kPi * height * (2.0 * reach - height);
    CHECK(std::abs(out.removed_mass - cap_volume(reach, height)) < 0.25 * 0.5 * kEdge * area);
    CHECK(std::abs(missing_mass(bone) - out.removed_mass) < 1e-9 * out.removed_mass);
  }
}

TEST_CASE("threshold: below the strength, without spin, force or contact nothing is removed") {
  const Affine pose = pressed(1.5e-3), above = pressed(-1e-3);
  Voxmap bone = plane();
  Erosion probe = make_erosion(ball_points(), law(1e30));
  const double stress = probe.step(bone, {pose, pose}, {.spin = 100.0, .force = 10.0}, 1e-3).stress;
  Erosion erosion = make_erosion(ball_points(), law(1.001 * stress));
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 100.0, .force = 10.0}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 0.0, .force = 20.0}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 100.0, .force = 0.0}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {above, above}, {.spin = 100.0, .force = 1e9}, 1e-3).touched == 0);
  CHECK(missing_mass(bone) == 0.0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 100.0, .force = 10.02}, 1e-3).touched > 0);  // just above the strength
}

TEST_CASE("threshold: a removed voxel has no density and is removed once; a path removes what the ball sweeps") {
  Voxmap bone = plane();
  Erosion erosion = make_erosion(ball_points(), law());
  const Affine from = pressed(1.5e-3), to = moved(from, Vec3(10.0, 0.0, 0.0));
  const ErosionOutcome first = erosion.step(bone, {from, to}, {.spin = 100.0, .force = 10.0}, 1e-3);
  bone.commit(first.changed);
  const double reach = 0.75 * cutting_ball(ball_points()).radius;
  const Vec3 shift(0.0, 0.0, cutting_ball(ball_points()).radius / kEdge);
  std::uint64_t inside = 0, left = 0;
  for_each_voxel({Vec3i(0), Vec3i(64, 64, 40)}, [&](const Vec3i& v) {
    // Distance to the segment of the centre; the pose advances by half a voxel, so a bulge of (1/4)^2 / (2 r) voxels is missed between.
    const Vec3 q = Vec3(v) - (from.offset + shift);
    const double along = glm::clamp(q.x, 0.0, 10.0);
    const double far = glm::length(q - Vec3(along, 0.0, 0.0)) * kEdge;
    const bool gone = bone.window().density[bone.window().box.offset_of(v)] == 0.0f;
    if (far <= reach - 0.01 * kEdge && along >= 0.5) inside += 1, left += gone ? 0 : 1;
    if (far > reach) CHECK_FALSE(gone);
  });
  CHECK(inside > 200);
  CHECK(left == 0);
  CHECK(erosion.step(bone, {from, to}, {.spin = 100.0, .force = 10.0}, 1e-3).touched == 0);
  CHECK(std::abs(missing_mass(bone) - first.removed_mass) < 1e-9 * first.removed_mass);
}

TEST_CASE("threshold: settings out of range are refused") {
  CHECK_FALSE(Erosion::create(law(0.0), ball_points()).ok());
  CHECK_FALSE(Erosion::create(law(1.0, 1.5), ball_points()).ok());
  CHECK(Erosion::create(law(1.0, 1.0), ball_points()).ok());
}
