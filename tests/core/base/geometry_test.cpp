#include "core/base/geometry.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

Vec3 random_vector(std::uint64_t seed, std::uint64_t counter) {
  return {uniform11(seed, 3 * counter), uniform11(seed, 3 * counter + 1), uniform11(seed, 3 * counter + 2)};
}

Vec3 random_direction(std::uint64_t seed, std::uint64_t counter) {
  const Vec3 v = random_vector(seed, counter);
  return glm::length(v) > 0.05 ? glm::normalize(v) : Vec3(0.0, 0.6, 0.8);
}

Pose random_pose(std::uint64_t seed, std::uint64_t counter) {
  const double half = 1.5 * uniform11(seed, 1000003 + counter);
  const Vec3 axis = random_direction(seed, counter);
  return {Quat(std::cos(half), axis * std::sin(half)), 0.1 * random_vector(seed + 1, counter)};
}

/// Directions all over the sphere, dense towards -z where the shortest rotation from +z is ill-defined.
std::vector<Vec3> directions() {
  std::vector<Vec3> all{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (std::uint64_t n = 0; n < 2000; ++n) all.push_back(random_direction(11, n));
  for (int decade = 0; decade <= 18; ++decade)
    for (int turn = 0; turn < 16; ++turn) {
      const double tilt = std::pow(10.0, -decade), azimuth = turn * std::numbers::pi / 8.0 + 0.1;
      const Vec3 near(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), -std::cos(tilt));
      all.push_back(near);
      all.push_back({near.x, near.y, -near.z});
    }
  return all;
}

}  // namespace

// A few roundings of numbers of order one each; a hundred of them is still far below any length that matters.
constexpr double kRounding = 1e-14;

TEST_CASE("Pose: the inverse undoes it on both sides, and products apply right to left") {
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Pose a = random_pose(1, n), b = random_pose(2, n);
    const Vec3 p = random_vector(3, n);
    REQUIRE(glm::length(a.inverse() * (a * p) - p) < kRounding);
    REQUIRE(glm::length(a * (a.inverse() * p) - p) < kRounding);
    REQUIRE(glm::length((a * b) * p - a * (b * p)) < kRounding);
    REQUIRE(glm::length(a.rotate(p) - (a * p - a * Vec3(0.0))) < kRounding);
    REQUIRE(glm::length(Affine::from_pose(a) * p - a * p) < kRounding);
  }
}

TEST_CASE("Affine: the inverse undoes sheared and anisotropic maps, and products apply right to left") {
  for (std::uint64_t n = 0; n < 300; ++n) {
    Affine a;
    for (std::size_t c = 0; c < 3; ++c) a.linear[c] = 0.3e-3 * random_vector(20 + c, n);
    for (std::size_t c = 0; c < 3; ++c) a.linear[c][c] += 1e-3;  // diagonally dominant: condition number below about 20
    a.offset = random_vector(30, n);
    const Vec3 p = 100.0 * random_vector(31, n);
    // The offset, 1000 voxel edges long, is taken off again: its rounding, 1e-16 of it, grows by the inverse's 1e3 to 1e-13 and some.
    REQUIRE(glm::length(a.inverse() * (a * p) - p) < 1e-11);
    const Affine b{Mat3(2.0), p};
    REQUIRE(glm::length((a * b) * p - a * (b * p)) < kRounding);
  }
}

TEST_CASE("Affine: edges and volume of a sheared cell in closed form") {
  Affine a;
  a.linear[0] = Vec3(3.0, 0.0, 0.0);
  a.linear[1] = Vec3(4.0, 2.0, 0.0);
  a.linear[2] = Vec3(1.0, 2.0, -4.5);
  CHECK(std::abs(a.cell_volume() - 27.0) < 1e-13);
  CHECK(std::abs(a.mean_edge() - 3.0) < 1e-14);
  CHECK(std::abs(a.longest_edge() - std::sqrt(25.25)) < 1e-14);
}

TEST_CASE("rotation_from_z: turns +z into every direction, -z and its neighbourhood included, by a unit quaternion") {
  double worst = 0.0, worst_norm = 0.0;
  for (const Vec3& axis : directions()) {
    const Quat q = rotation_from_z(axis);
    worst = std::max(worst, glm::length(q * Vec3(0.0, 0.0, 1.0) - axis));
    worst_norm = std::max(worst_norm, std::abs(glm::length(q) - 1.0));
  }
  MESSAGE("largest miss of the axis " << worst << ", of the norm " << worst_norm);
  CHECK(worst < kRounding);
  CHECK(worst_norm < kRounding);
}

TEST_CASE("rotation_from_z: is the shortest rotation, its axis lies in the xy plane") {
  for (const Vec3& axis : directions()) {
    const Quat q = rotation_from_z(axis);
    REQUIRE(std::abs(q.z) < kRounding);
    // cos(angle) = 2 w^2 - 1 of the rotation equals z of the axis for the shortest one.
    REQUIRE(std::abs(2.0 * q.w * q.w - 1.0 - axis.z) < kRounding);
  }
}

TEST_CASE("floor_int: equals std::floor at integers, their neighbours and at random up to 2^31") {
  for (int n = -3000; n <= 3000; ++n) {
    const double x = n;
    for (const double y : {x, std::nextafter(x, 1e9), std::nextafter(x, -1e9), x + 0.5, x - 0.25})
      REQUIRE(floor_int(y) == static_cast<int>(std::floor(y)));
  }
  for (std::uint64_t n = 0; n < 20000; ++n) {
    const double x = 2147483000.0 * uniform11(9, n) * std::pow(10.0, -10.0 * uniform01(10, n));
    REQUIRE(floor_int(x) == static_cast<int>(std::floor(x)));
  }
  CHECK(floor_int(-0.0) == 0);
  CHECK(floor_int(-5e-324) == -1);
}

TEST_CASE("voxel_of: a cell is its centre +- 1/2, the lower face belongs to it") {
  CHECK(voxel_of({0.0, 0.0, 0.0}) == Vec3i(0, 0, 0));
  CHECK(voxel_of({0.5, -0.5, 1.5}) == Vec3i(1, 0, 2));
  CHECK(voxel_of({-0.51, 0.49, -1.5}) == Vec3i(-1, 0, -1));
  for (std::uint64_t n = 0; n < 5000; ++n) {
    const Vec3 p = 50.0 * random_vector(12, n);
    REQUIRE(voxel_of(p) == Vec3i(glm::floor(p + 0.5)));
  }
}

TEST_CASE("VoxelBox: for_each_voxel, offset_of, contains and count agree, i fastest") {
  const VoxelBox box{{-3, 2, 5}, {1, 4, 8}};
  std::size_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    REQUIRE(box.contains(v));
    REQUIRE(box.offset_of(v) == n++);
  });
  CHECK(n == box.count());
  CHECK(n == 4 * 2 * 3);
  CHECK_FALSE(box.contains(box.hi));
  CHECK(box.contains(VoxelBox{{-3, 2, 5}, {1, 4, 8}}));
  CHECK_FALSE(box.contains(box.grown(1)));
  CHECK(box.grown(1).grown(-1) == box);
}

TEST_CASE("VoxelBox: unite and intersect hold exactly the voxels they should, empty boxes included") {
  for (std::uint64_t n = 0; n < 400; ++n) {
    const auto corner = [n](std::uint64_t k) { return Vec3i(glm::floor(5.0 * random_vector(40 + k, n))); };
    const VoxelBox a{corner(0), corner(0) + glm::abs(corner(1))}, b{corner(2), corner(2) + glm::abs(corner(3))};
    const VoxelBox both = a.unite(b), common = a.intersect(b);
    REQUIRE((both.contains(a) && both.contains(b)));
    for_each_voxel({Vec3i(-6), Vec3i(11)}, [&](const Vec3i& v) { REQUIRE(common.contains(v) == (a.contains(v) && b.contains(v))); });
    VoxelBox grown;
    for_each_voxel(a, [&](const Vec3i& v) { grown.include(v); });
    if (!a.empty()) REQUIRE(grown == a);
  }
}
