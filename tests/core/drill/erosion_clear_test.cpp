#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/core/drill/swept_solid.h"

using namespace burrhole;
using namespace burrhole::test;

// "All cleared": e s so large that every voxel that a point meets is gone at once.

namespace {

constexpr float kAtOnce = 1e12f;
constexpr double kHalfDiagonal = 0.8660254037844387;  // [voxels] of a cell

// A voxel centre deeper in the tool than this is certainly cleared: some point of the lattice, pitch 1/2, lies within half the diagonal of
// its cell, 0.433 voxel, of any place, and so within the voxel's inscribed ball of 1/2; sub-steps lie at most 1/2 voxel apart, so within
// 0.25 voxel of any place on the way.
constexpr double kInset = 0.4331 + 0.25;

SweptSolid sweep(bool ball, std::uint64_t seed, double voxel = 0.25e-3) {
  SweptSolid solid{.ball = ball, .radius = 1.4e-3, .height = 2.2e-3, .voxel = voxel};
  const std::array<Vec3, 4> ways{Vec3(1.9e-3, 0.3e-3, 0.7e-3), Vec3(-0.2e-3, 1.1e-3, -1.6e-3), Vec3(1.2e-3, 1.2e-3, 1.2e-3), Vec3(0.0)};
  solid.way = ways[seed % 4] / voxel;
  solid.from = turned_pose(voxel, Vec3(4.5e-3) / voxel + Vec3(0.13, 0.27, 0.39) - 0.5 * solid.way, seed);
  return solid;
}

Voxmap cleared_by(const SweptSolid& solid) {
  const int edge = static_cast<int>(std::lround(9e-3 / solid.voxel));
  Voxmap voxmap = Block{.dims = Vec3i(edge), .pitch = solid.voxel}.make();
  Erosion erosion = make_erosion(solid.points(0.5 * solid.voxel, kAtOnce));
  const ErosionOutcome outcome = erosion.step(voxmap, solid.path(), 1.0, 1e-3);
  voxmap.commit(outcome.changed);
  REQUIRE(outcome.outside == 0);
  return voxmap;
}

std::string name_of(bool ball) { return ball ? "ball " : "cylinder "; }

template <class F>
void for_each_cleared(const Voxmap& voxmap, F&& f) {
  const MasterWindow& window = voxmap.window();
  for_each_voxel(window.box, [&](const Vec3i& v) { f(v, window.remaining[window.box.offset_of(v)] == 0.0f); });
}

double cleared_volume(const Voxmap& voxmap) {
  double count = 0.0;
  for_each_cleared(voxmap, [&](const Vec3i&, bool cleared) { count += cleared ? 1.0 : 0.0; });
  return count;
}

}  // namespace

TEST_CASE("erosion, all cleared: the voxels cleared are the slow twin's, voxel for voxel") {
  for (const bool ball : {true, false})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(ball);
      CAPTURE(seed);
      const SweptSolid solid = sweep(ball, seed);
      Voxmap voxmap = cleared_by(solid);
      const ErosionPoints points = solid.points(0.5 * solid.voxel, kAtOnce);
      PlainErosion twin(voxmap, points, {});
      twin.step(solid.path(), make_erosion(points).substeps_for(solid.path()), 1.0, 1e-3);
      REQUIRE(twin.on_a_face() == 0);
      int wrong = 0, partly = 0;
      for_each_cleared(voxmap, [&](const Vec3i& v, bool cleared) {
        wrong += cleared == (twin.cells().count({v.x, v.y, v.z}) == 1) ? 0 : 1;
        const float left = voxmap.window().remaining[voxmap.window().box.offset_of(v)];
        partly += left > 0.0f && left < 1.0f ? 1 : 0;
      });
      CHECK(wrong == 0);
      CHECK(partly == 0);
      CHECK(twin.cells().size() > 500);
    }
}

TEST_CASE("erosion, all cleared: holds the swept tool shrunk by 0.68 voxel and stays in the swept tool grown by 0.75 voxel") {
  double furthest = 0.0;
  for (const bool ball : {true, false})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      CAPTURE(ball);
      CAPTURE(seed);
      const SweptSolid solid = sweep(ball, seed);
      int missed = 0, missed_in_tool = 0, beyond = 0, in_tool = 0;
      for_each_cleared(cleared_by(solid), [&](const Vec3i& v, bool cleared) {
        if (!cleared && solid.surely_outside(Vec3(v))) return;
        const double outside = solid.distance(Vec3(v), 0.0);
        in_tool += outside == 0.0 ? 1 : 0;
        if (cleared) {
          furthest = std::max(furthest, outside);
          beyond += outside > 0.75 ? 1 : 0;
        } else if (outside == 0.0) {
          ++missed_in_tool;
          missed += solid.distance(Vec3(v), kInset) < 1e-9 ? 1 : 0;
        }
      });
      MESSAGE(name_of(ball) << seed << ": centres in the swept tool " << in_tool << ", of them left " << missed_in_tool
                            << ", cleared beyond 0.75 voxel " << beyond);
      CHECK(missed == 0);
      CHECK(missed_in_tool <= in_tool / 200);  // close to the tool's edge a voxel may hold no point
      CHECK(beyond == 0);
    }
  MESSAGE("furthest voxel cleared: centre " << furthest << " voxel outside the swept tool");
  CHECK(furthest <= kHalfDiagonal);  // a point of the tool lies in the cell
}

TEST_CASE("erosion, all cleared: the excess over the closed form of the swept volume falls in proportion to the voxel pitch") {
  for (const bool ball : {true, false}) {
    std::array<double, 3> excess{}, relative{};
    const std::array<double, 3> pitches{0.5e-3, 0.25e-3, 0.125e-3};
    for (std::size_t n = 0; n < 3; ++n)
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const SweptSolid solid = sweep(ball, seed, pitches[n]);
        const double cell = std::pow(pitches[n] * 1e3, 3.0);  // [mm3]
        excess[n] += (cleared_volume(cleared_by(solid)) - solid.volume()) * cell / 3.0;
        relative[n] += solid.volume() * cell / 3.0;
      }
    // Least squares through three equally spaced logarithms is the slope between the outer two.
    const double slope = std::log(excess[0] / excess[2]) / std::log(4.0);
    MESSAGE(name_of(ball) << excess[0] << ", " << excess[1] << ", " << excess[2] << " mm3 of " << relative[2] << ", slope " << slope);
    CHECK(slope > 0.8);
    CHECK(slope < 1.2);
  }
}

TEST_CASE("erosion: a hand that moves 30 voxels in one step skips no bone, a single sub-step does") {
  for (const bool ball : {true, false}) {
    SweptSolid solid{.ball = ball, .radius = 0.5e-3, .height = 1.0e-3, .voxel = 0.25e-3};
    solid.way = 29.9 * glm::normalize(Vec3(1.0, 0.4, 0.7));
    solid.from = turned_pose(solid.voxel, Vec3(6.2, 7.3, 5.4), 3);
    const auto left_in_tool = [&](Voxmap& voxmap) {
      int left = 0;
      for_each_cleared(voxmap, [&](const Vec3i& v, bool cleared) {
        left += !cleared && !solid.surely_outside(Vec3(v)) && solid.distance(Vec3(v), kInset) < 1e-9 ? 1 : 0;
      });
      return left;
    };
    Voxmap voxmap = cleared_by(solid);
    CHECK(left_in_tool(voxmap) == 0);

    Erosion erosion = make_erosion(solid.points(0.5 * solid.voxel, kAtOnce));
    CHECK(erosion.substeps_for(solid.path()) == 60);
    Voxmap skipped = Block{.dims = Vec3i(36), .pitch = solid.voxel}.make();
    const Affine middle = moved(solid.from, 0.5 * solid.way);  // where a single sub-step would act
    skipped.commit(erosion.step(skipped, {middle, middle}, 1.0, 1e-3).changed);
    CHECK(left_in_tool(skipped) > 100);
  }
}

TEST_CASE("erosion: sub-steps follow the point that moves most, turning included, and are never fewer than one") {
  const double voxel = 0.5e-3;
  Erosion erosion = make_erosion(lattice(Cylinder{1.0e-3, 6.0e-3}, 0.25e-3, 1.0f));
  const Affine pose = upright_pose(voxel, Vec3(10.0));
  CHECK(erosion.substeps_for({pose, pose}) == 1);
  CHECK(erosion.substeps_for({pose, moved(pose, Vec3(0.0, 0.3, 0.0))}) == 1);
  CHECK(erosion.substeps_for({pose, moved(pose, Vec3(0.0, 0.9, 0.0))}) == 2);
  // Tilted about the tip by 0.2 rad: the top, 12 voxels up, moves by 2 * 12 * sin(0.1) = 2.4 voxels.
  Affine tilted = pose;
  tilted.linear = glm::mat3_cast(Quat(std::cos(0.1), std::sin(0.1), 0.0, 0.0)) * pose.linear;
  CHECK(erosion.substeps_for({pose, tilted}) >= 5);
  CHECK(erosion.substeps_for({pose, tilted}) <= 6);
}
