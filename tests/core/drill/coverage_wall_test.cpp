#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/random.h"
#include "tests/core/drill/coverage_cases.h"

using namespace burrhole;
using namespace burrhole::test;

// The wall that a cylinder leaves when it is pushed down its own axis: its end is a plane, its side a cylinder; and the groove of a ball.

namespace {

constexpr double kVoxel = 0.25e-3;
constexpr double kRadius = 8.0, kHeight = 16.0, kWay = 5.0;  // [voxels]

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

Voxmap drilled(const SweptSolid& solid, const ErosionConfig& config) {
  Voxmap voxmap = Block{.dims = Vec3i(46), .pitch = kVoxel}.make();
  Erosion erosion = subvoxel_erosion(solid, kAtOnce, config);
  (void)sweep_through(voxmap, erosion, solid, 40);
  return voxmap;
}

/// Twelve walls: axes along the grid, near it, and any.
Walls walls_of(const ErosionConfig& config) {
  Walls walls;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto u = [&](std::uint64_t n) { return uniform01(seed, 40 + n); };
    SweptSolid solid{.ball = false, .radius = kRadius * kVoxel, .height = kHeight * kVoxel, .voxel = kVoxel};
    const double tilt = seed <= 3 ? 0.0 : seed <= 6 ? 0.1 : 1.0;
    const Vec3 axis = glm::normalize(Vec3(0.0, 0.0, 1.0) + tilt * Vec3(uniform11(seed, 1), uniform11(seed, 2), 0.0));
    solid.from.linear = glm::mat3_cast(rotation_from_z(axis)) * (1.0 / kVoxel);
    solid.way = -kWay * axis;
    solid.from.offset = Vec3(22.0) + Vec3(u(3), u(4), u(5)) - 0.5 * solid.way - 0.5 * kHeight * axis;
    Voxmap voxmap = drilled(solid, config);
    const Affine end = moved(solid.from, solid.way);
    for (std::uint64_t n = 0; n < 150; ++n) {
      const double angle = 2.0 * std::numbers::pi * u(100 + 3 * n), r = (kRadius - 2.5) * std::sqrt(u(101 + 3 * n));
      const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
      walls.plane.add(voxmap.window(), end * (r * kVoxel * out), -axis);
      const double z = (2.5 + (kHeight - 5.0) * u(102 + 3 * n)) * kVoxel;
      walls.side.add(voxmap.window(), end * (solid.radius * out + Vec3(0.0, 0.0, z)), glm::normalize(end.linear * out));
    }
    SweptSolid ball{.ball = true, .radius = kRadius * kVoxel, .voxel = kVoxel, .from = solid.from, .way = Vec3(8.0, 5.0, 3.0)};
    ball.from.offset = Vec3(19.0) + Vec3(u(3), u(4), u(5)) - ball.from.linear * Vec3(0.0, 0.0, ball.radius);
    Voxmap groove = drilled(ball, config);
    const Vec3 along = glm::normalize(ball.way), across = glm::normalize(glm::cross(along, Vec3(0.3, 0.2, 0.9)));
    for (std::uint64_t n = 0; n < 150; ++n) {
      const double angle = 2.0 * std::numbers::pi * u(1000 + 2 * n);
      const Vec3 out = std::cos(angle) * across + std::sin(angle) * glm::cross(along, across);
      const Vec3 centre = ball.from * Vec3(0.0, 0.0, ball.radius) + u(1001 + 2 * n) * ball.way;
      walls.groove.add(groove.window(), centre + kRadius * out, out);
    }
  }
  for (Wall* wall : {&walls.plane, &walls.side, &walls.groove}) wall->finish();
  return walls;
}

}  // namespace

TEST_CASE("coverage: the wall of a hole lies within 0.1 voxel of the true one for 99 % of it, with its normal within 5 degrees rms") {
  const std::array<std::string, 3> names{"cell", "trapezoid", "wide"};
  for (const CoverageKernel kernel : {CoverageKernel::cell, CoverageKernel::trapezoid, CoverageKernel::wide}) {
    const Walls walls = walls_of({.subvoxel = true, .kernel = kernel, .clear_below = 0.0f});
    const std::string& name = names[static_cast<std::size_t>(kernel)];
    MESSAGE(name << ", plane: " << walls.plane.text());
    MESSAGE(name << ", side: " << walls.side.text());
    MESSAGE(name << ", groove: " << walls.groove.text());
    if (kernel == CoverageKernel::cell) continue;
    for (const Wall* wall : {&walls.plane, &walls.side, &walls.groove}) {
      // 64 samples know the share of a half-space to 0.06 at worst (0.018 rms), 0.08 voxel of wall where the kernel rises at 3/4 a voxel;
      // the kernel's own ripple of 0.05 voxel comes on top. Both at their worst are rare.
      CHECK(wall->beyond < wall->places / 100);
      CHECK(wall->worst < 0.13);
      CHECK(wall->rms < 0.05);
      CHECK(wall->tilt < 5.0);
      CHECK(wall->worst_tilt < 12.0);
    }
  }
}

TEST_CASE("coverage: without it the same walls are steps of a voxel") {
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
