#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/random.h"
#include "tests/core/drill/subvoxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

// The wall that a cylinder leaves when it is pushed down its own axis: its end is a plane, its side a cylinder; and the groove of a ball.

namespace {

constexpr double kVoxel = 0.25e-3;
constexpr double kRadius = 8.0, kHeight = 16.0, kWay = 10.0;  // [voxels]

struct Wall {
  int places = 0, beyond = 0;                 ///< beyond: farther than 0.1 voxel from the true surface
  double mean = 0.0, worst = 0.0, rms = 0.0;  ///< [voxels] of the 0.5 surface from the true one, outward positive
  double tilt = 0.0, worst_tilt = 0.0;        ///< [deg] of its normal, root mean square and worst

  void add(const MasterWindow& window, const Vec3& p, const Vec3& outward) {
    const double offset = surface_offset(window, p, outward);
    REQUIRE(std::isfinite(offset));
    const double cosine = std::clamp(glm::dot(rise_at(window, p + offset * outward), outward), -1.0, 1.0);
    const double angle = std::acos(cosine) * 180.0 / std::numbers::pi;
    ++places;
    mean += offset;
    beyond += std::abs(offset) > 0.1 ? 1 : 0;
    rms += offset * offset;
    worst = std::max(worst, std::abs(offset));
    tilt += angle * angle;
    worst_tilt = std::max(worst_tilt, angle);
  }
  void finish() {
    mean /= places;
    rms = std::sqrt(rms / places);
    tilt = std::sqrt(tilt / places);
  }
  [[nodiscard]] std::string text() const {
    return std::to_string(100.0 * beyond / places) + " % beyond 0.1 voxel, " + std::to_string(worst) + " voxel at worst (mean " +
           std::to_string(mean) + ", rms " + std::to_string(rms) + "), normals " + std::to_string(worst_tilt) + " deg at worst (rms " +
           std::to_string(tilt) + ")";
  }
};

struct Walls {
  Wall plane, side, groove;
};

constexpr int kSteps = 80;  // of the tool's way

/// Bone ahead of a plane through `face` [voxels], after the tool's way into it. @param runs the way is cut in so many runs, each from the
/// voxels that the one before has left.
Voxmap drilled(const SweptSolid& solid, const Vec3& face, const ErosionConfig& config, int runs) {
  const Vec3 ahead = glm::normalize(solid.way);
  DenseBone dense;
  dense.dims = Vec3i(60);
  dense.bone_from_index = Affine::scaling(kVoxel, Vec3(0.0));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    dense.occupancy.push_back(static_cast<float>(std::clamp(glm::dot(Vec3(v) - face, ahead) + 0.5, 0.0, 1.0)));
    dense.hardness.push_back(1.0f);
  });
  Voxmap voxmap = voxmap_of(dense);
  for (int run = 0; run < runs; ++run) {
    SweptSolid part = solid;
    part.way = solid.way / static_cast<double>(runs);
    part.from = moved(solid.from, static_cast<double>(run) * part.way);
    Erosion erosion = subvoxel_erosion(part, kAtOnce, config);
    (void)sweep_through(voxmap, erosion, part, kSteps / runs);
    if (run + 1 == runs) break;
    voxmap.write_back();
    voxmap.put_blocks({});
    REQUIRE(voxmap.cut().empty());
  }
  return voxmap;
}

/// Twelve walls: axes along the grid, near it, and any.
Walls walls_of(const ErosionConfig& config, int runs = 1) {
  Walls walls;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto u = [&](std::uint64_t n) { return uniform01(seed, 40 + n); };
    SweptSolid solid{.ball = false, .radius = kRadius * kVoxel, .height = kHeight * kVoxel, .voxel = kVoxel};
    const double tilt = seed <= 3 ? 0.0 : seed <= 6 ? 0.1 : 1.0;
    const Vec3 axis = glm::normalize(Vec3(0.0, 0.0, 1.0) + tilt * Vec3(uniform11(seed, 1), uniform11(seed, 2), 0.0));
    solid.from.linear = glm::mat3_cast(rotation_from_z(axis)) * (1.0 / kVoxel);
    solid.way = -kWay * axis;
    solid.from.offset = Vec3(29.0) + Vec3(u(3), u(4), u(5)) - 0.5 * solid.way;
    Voxmap voxmap = drilled(solid, solid.from.offset, config, runs);
    const Affine end = moved(solid.from, solid.way);
    for (std::uint64_t n = 0; n < 150; ++n) {
      const double angle = 2.0 * std::numbers::pi * u(100 + 3 * n), r = (kRadius - 2.5) * std::sqrt(u(101 + 3 * n));
      const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
      walls.plane.add(voxmap.window(), end * (r * kVoxel * out), -axis);
      const double z = (2.5 + (kWay - 5.0) * u(102 + 3 * n)) * kVoxel;
      walls.side.add(voxmap.window(), end * (solid.radius * out + Vec3(0.0, 0.0, z)), glm::normalize(end.linear * out));
    }
    SweptSolid ball{.ball = true, .radius = kRadius * kVoxel, .voxel = kVoxel, .from = solid.from, .way = Vec3(16.0, 10.0, 6.0)};
    const Vec3 start = Vec3(19.0) + Vec3(u(3), u(4), u(5));
    ball.from.offset = start - ball.from.linear * Vec3(0.0, 0.0, ball.radius);
    Voxmap groove = drilled(ball, start + kRadius * glm::normalize(ball.way), config, runs);
    const Vec3 along = glm::normalize(ball.way), across = glm::normalize(glm::cross(along, Vec3(0.3, 0.2, 0.9)));
    for (std::uint64_t n = 0; n < 150; ++n) {
      const double angle = 2.0 * std::numbers::pi * u(1000 + 2 * n);
      const Vec3 out = std::cos(angle) * across + std::sin(angle) * glm::cross(along, across);
      const Vec3 centre = start + (0.6 + 0.4 * u(1001 + 2 * n)) * ball.way;  // the ball's middle is two voxels and more inside
      walls.groove.add(groove.window(), centre + kRadius * out, out);
    }
  }
  for (Wall* wall : {&walls.plane, &walls.side, &walls.groove}) wall->finish();
  return walls;
}

}  // namespace

TEST_CASE("cut face: the wall of a hole lies within 0.1 voxel of the true one for 99 % of it, with its normal within 5 degrees rms") {
  const Walls walls = walls_of({.subvoxel = true});
  MESSAGE("plane: " << walls.plane.text());
  MESSAGE("side: " << walls.side.text());
  MESSAGE("groove: " << walls.groove.text());
  for (const Wall* wall : {&walls.plane, &walls.side, &walls.groove}) {
    // The ramp of density is linear up to 3/4 voxel from the face: 0.02 voxel for a face along the grid. Elsewhere corners of a cell lie up to
    // 0.87 voxel from a face through its middle, where the ramp has ended.
    CHECK(wall->beyond < wall->places / 100);
    CHECK(wall->worst < 0.13);
    CHECK(wall->rms < 0.05);
    CHECK(wall->tilt < 5.0);
    CHECK(wall->worst_tilt < 12.0);
  }
}

TEST_CASE(
    "cut face: the wall of a hole that is cut in runs, each from the voxels that the one before has left, lies where that of one run "
    "lies") {
  const Walls one = walls_of({.subvoxel = true}), many = walls_of({.subvoxel = true}, 8);
  const auto compare = [](const Wall& a, const Wall& b) {
    MESSAGE("in runs: " << b.text());
    // The bounds of one run: voxels hold the ramp of the earlier cut, and the deeper of the two cuts applies, as in one run.
    CHECK(b.beyond < b.places / 100);
    CHECK(b.worst < 0.13);
    CHECK(b.rms < 0.05);
    CHECK(b.tilt < 5.0);
    CHECK(std::abs(b.mean - a.mean) < 0.05);
  };
  compare(one.plane, many.plane);
  compare(one.side, many.side);
  compare(one.groove, many.groove);
}

TEST_CASE("cut face: without it the same walls are steps of a voxel") {
  const Walls walls = walls_of({});
  MESSAGE("without, plane: " << walls.plane.text());
  MESSAGE("without, side: " << walls.side.text());
  MESSAGE("without, groove: " << walls.groove.text());
  for (const Wall* wall : {&walls.plane, &walls.side, &walls.groove}) {
    CHECK(wall->beyond > wall->places / 2);
    CHECK(wall->rms > 0.2);
    CHECK(wall->tilt > 8.0);
    CHECK(wall->worst_tilt > 20.0);
  }
}
