#include "core/drill/exposure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPitch = 0.5e-3;

/// Exposure from its definition: each point by itself, in double, into a map. Shares nothing with the scatter.
struct PlainCount {
  std::map<std::tuple<int, int, int>, double> sums;
  std::uint32_t outside = 0;
  int on_a_face = 0;  ///< points within 1e-9 voxel of a face, further than 2^-31 of the fixed point: these could fall either way

  PlainCount(const ErosionPoints& points, const Affine& pose, const VoxelBox& allowed) {
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec3 p = pose * points.positions[n] + 0.5;
      const Vec3 past = p - glm::floor(p);
      for (std::size_t axis = 0; axis < 3; ++axis) on_a_face += past[axis] < 1e-9 || past[axis] > 1.0 - 1e-9 ? 1 : 0;
      const Vec3i v(glm::floor(p));
      if (allowed.contains(v))
        sums[{v.x, v.y, v.z}] += static_cast<double>(points.factors[n]);
      else
        ++outside;
    }
  }
};

/// @returns voxels whose exposure differs by more than `tolerance`, and zero only where the field is empty where the count is.
int differences(const ExposureField& field, const PlainCount& plain, double tolerance) {
  int wrong = 0;
  std::size_t met = 0;
  for_each_voxel(field.box, [&](const Vec3i& v) {
    const auto found = plain.sums.find({v.x, v.y, v.z});
    const double expected = found == plain.sums.end() ? 0.0 : found->second;
    met += found == plain.sums.end() ? 0 : 1;
    wrong += std::abs(field.at(v) - expected) <= tolerance ? 0 : 1;
  });
  return wrong + static_cast<int>(plain.sums.size() - met);
}

ErosionPoints ball(double pitch, std::uint64_t seed, bool even) {
  ErosionPoints points = lattice(Ball{2.3e-3}, pitch, 0.25f);
  for (std::size_t n = 0; !even && n < points.size(); ++n) points.factors[n] = static_cast<float>(uniform01(seed, n));
  return points;
}

ErosionPoints shuffled(const ErosionPoints& points, std::uint64_t seed) {
  ErosionPoints out = points;
  for (std::size_t n = points.size() - 1; n > 0; --n) {
    const auto m = static_cast<std::size_t>(uniform01(seed, n) * static_cast<double>(n + 1));
    std::swap(out.positions[n], out.positions[m]);
    std::swap(out.factors[n], out.factors[m]);
  }
  return out;
}

Voxmap bone(int edge = 26) { return Block{.dims = Vec3i(edge), .pitch = kPitch}.make(); }

// 38 bits below the largest factor are kept: half of the last for each of some 300 points in a voxel.
constexpr double kManyFactors = 300.0 * 0x1p-38;

}  // namespace

TEST_CASE("exposure: equals a plain count at random poses, for one factor and for many, on a lattice and in any order") {
  const Voxmap voxmap = bone();
  for (const bool even : {true, false})
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      CAPTURE(even);
      CAPTURE(seed);
      const ErosionPoints points = ball(kPitch * (0.21 + 0.4 * uniform01(seed, 1)), seed, even);
      const Affine pose =
          turned_pose(kPitch, Vec3(11.3, 12.1, 9.7) + 1.5 * Vec3(uniform11(seed, 5), uniform11(seed, 6), uniform11(seed, 7)), seed);
      const PlainCount plain(points, pose, voxmap.window().erodible_box());
      REQUIRE(plain.on_a_face == 0);
      ExposureField field, mixed;
      PointScatter scatter(points), other(shuffled(points, seed));
      CHECK(scatter.add(voxmap.window(), pose, field) == plain.outside);
      CHECK(differences(field, plain, even ? 0.0 : kManyFactors) == 0);
      CHECK(other.add(voxmap.window(), pose, mixed) == plain.outside);
      CHECK(mixed.box == field.box);
      CHECK(mixed.sums == field.sums);
      // Sabotage: the same check sees a shift of a hundredth of a voxel and a single point lost.
      PlainCount moved_count(points, moved(pose, Vec3(1e-2, 0.0, 0.0)), voxmap.window().erodible_box());
      CHECK(differences(field, moved_count, kManyFactors) > 0);
      ErosionPoints fewer = points;
      fewer.positions.erase(fewer.positions.begin() + 100);
      fewer.factors.erase(fewer.factors.begin() + 100);
      CHECK(differences(field, PlainCount(fewer, pose, voxmap.window().erodible_box()), kManyFactors) == 1);
    }
}

TEST_CASE("exposure: same bits at every SIMD level, window's edge and points on no lattice included") {
  const SimdLevelGuard guard;
  Voxmap voxmap = bone();
  REQUIRE(voxmap.place_window({Vec3i(2, 1, 3), Vec3i(23, 24, 19)}).ok());
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    ErosionPoints points = ball(kPitch * (0.21 + 0.4 * uniform01(seed, 1)), seed, seed % 2 == 0);
    if (seed % 3 == 0)
      for (std::size_t n = 0; n < points.size(); ++n)
        points.positions[n] += 1e-5 * Vec3(uniform11(seed, 3 * n), uniform11(seed, 3 * n + 1), 0.0);
    const Affine pose = turned_pose(kPitch, Vec3(10.0) + 9.0 * Vec3(uniform11(seed, 5), uniform11(seed, 6), uniform11(seed, 7)), seed);
    const PlainCount plain(points, pose, voxmap.window().erodible_box());
    REQUIRE(plain.on_a_face == 0);
    for (const SimdLevel level : simd_levels()) {
      CAPTURE(name_of(level));
      REQUIRE(choose_simd(name_of(level)).ok());
      ExposureField field;
      PointScatter scatter(points);
      CHECK(scatter.add(voxmap.window(), pose, field) == plain.outside);
      CHECK(differences(field, plain, seed % 2 == 0 ? 0.0 : kManyFactors) == 0);
      // Every point is somewhere: whole numbers, so exactly.
      if (seed % 2 == 0) {
        const std::int64_t sum = std::accumulate(field.sums.begin(), field.sums.end(), std::int64_t{0});
        CHECK(static_cast<double>(sum) * field.unit == 0.25 * static_cast<double>(points.size() - plain.outside));
      }
    }
  }
}

TEST_CASE("exposure: a point on a face belongs to the voxel above, far away ones are counted outside") {
  const Voxmap voxmap = bone(12);
  ErosionPoints points{.pitch = 1.0,
                       .positions = {Vec3(4.5, 5.0, 5.0), Vec3(4.5 - 0x1p-40, 5.0, 5.0), Vec3(4.499, 5.0, 5.0)},
                       .factors = {1.0f, 1.0f, 1.0f}};
  ExposureField field;
  PointScatter scatter(points);
  CHECK(scatter.add(voxmap.window(), Affine{}, field) == 0);
  CHECK(field.at({5, 5, 5}) == 2.0);  // the second is rounded onto the face: 2^-40 voxel is below the fixed point's last place
  CHECK(field.at({4, 5, 5}) == 1.0);
  for (const double far : {1e3, -1e3, 1e6, 1e12, -1e300}) {
    CAPTURE(far);
    ExposureField none;
    CHECK(PointScatter(points).add(voxmap.window(), {Mat3(1.0), Vec3(far, 0.0, 0.0)}, none) == 3);
  }
  // A run whose pitch is so long that it leaves the fixed point's range counts the one point that is inside.
  const ErosionPoints sparse{.pitch = 1e9, .positions = {Vec3(5.0), Vec3(5.0 + 1e9, 5.0, 5.0)}, .factors = {1.0f, 1.0f}};
  ExposureField one;
  CHECK(PointScatter(sparse).add(voxmap.window(), Affine{}, one) == 1);
  CHECK(one.at({5, 5, 5}) == 1.0);
}
