// What bone can push with, against closed forms and a plain twin; and its normals on bone of known shape.
#include "app/lab/oracle/contact_cone.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "volumes/phantom/phantom.h"

using namespace burrhole;

namespace {

const Vec3 kX(1.0, 0.0, 0.0), kY(0.0, 1.0, 0.0), kZ(0.0, 0.0, 1.0);

double outside(const Vec3& force, std::vector<Vec3> normals) { return outside_cone(force, normals); }

/// Twin that shares nothing: loads of all normals, each in turn the best while the others stay (the sum of squares is convex), often
/// enough.
double slowly_outside(const Vec3& force, const std::vector<Vec3>& normals) {
  std::vector<double> load(normals.size(), 0.0);
  Vec3 left = force;
  for (int round = 0; round < 20000; ++round)
    for (std::size_t n = 0; n < normals.size(); ++n) {
      const double to = std::max(0.0, load[n] + glm::dot(left, normals[n]));
      left -= normals[n] * (to - load[n]);
      load[n] = to;
    }
  return glm::length(left);
}

Vec3 any_direction(std::uint64_t seed, std::uint64_t n) {
  const double z = 2.0 * uniform01(seed, 2 * n) - 1.0, turn = 2.0 * std::numbers::pi * uniform01(seed, 2 * n + 1);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

std::vector<Vec3> normals_at(const PhantomSpec& spec, std::initializer_list<Vec3> points) {
  auto phantom = make_phantom(spec);
  REQUIRE(phantom.ok());
  const Affine bone_from_index = phantom->bone.bone_from_index;
  auto bone = BoneModel::create(phantom->bone);
  REQUIRE(bone.ok());
  auto voxmap = Voxmap::create(std::move(bone).value(), {});
  REQUIRE(voxmap.ok());
  REQUIRE(voxmap->place_window(voxmap->bone().bounds()).ok());
  std::vector<Vec3> out;
  touched_normals(voxmap->window(), bone_from_index, std::vector<Vec3>(points), out);
  return out;
}

bool has(const std::vector<Vec3>& normals, const Vec3& direction, double cosine) {
  return std::ranges::any_of(normals, [&](const Vec3& n) { return glm::dot(n, direction) > cosine; });
}

}  // namespace

TEST_CASE("contact cone: without bone all of a force is outside, and one wall pushes along its normal only") {
  CHECK(outside({3.0, 0.0, 4.0}, {}) == 5.0);
  CHECK(outside({0.0, 0.0, 4.0}, {kZ}) == 0.0);
  CHECK(outside({0.0, 0.0, -4.0}, {kZ}) == 4.0);                  // all of what points into bone
  CHECK(outside({3.0, 0.0, -4.0}, {kZ}) == 5.0);                  // and never less than that
  CHECK(outside({3.0, 0.0, 4.0}, {kZ}) == doctest::Approx(3.0));  // what lies across
}

TEST_CASE("contact cone: two walls, opposed or square to each other, and a corner") {
  CHECK(outside({-2.0, 0.0, 0.0}, {kX, -kX}) == 0.0);
  CHECK(outside({-2.0, 3.0, 0.0}, {kX, -kX}) == doctest::Approx(3.0));
  CHECK(outside({2.0, 1.0, 0.0}, {kX, kY}) < 1e-9);
  CHECK(outside({2.0, -1.0, 0.5}, {kX, kY}) == doctest::Approx(std::sqrt(1.25)));
  CHECK(outside({1.0, 2.0, 3.0}, {kX, kY, kZ}) < 1e-9);
  CHECK(outside({1.0, 2.0, -3.0}, {kX, kY, kZ}) == doctest::Approx(3.0));
  CHECK(outside({-1.0, -2.0, -3.0}, {kX, kY, kZ}) == doctest::Approx(std::sqrt(14.0)));
  // A pit: floor and walls all round push anywhere but down.
  const std::vector<Vec3> pit{kZ, kX, -kX, kY, -kY};
  CHECK(outside({1.0, -2.0, 0.1}, pit) < 1e-9);
  CHECK(outside({1.0, -2.0, -0.1}, pit) == doctest::Approx(0.1));
  // Around a post nothing is out of reach.
  CHECK(outside({1.0, -2.0, -0.1}, {kZ, -kZ, kX, -kX, kY, -kY}) < 1e-9);
}

TEST_CASE("contact cone: as a slow twin finds it, whatever the normals") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    std::vector<Vec3> normals;
    // Few, many, and such as lie within half a sphere.
    for (std::uint64_t n = 0; n < 1 + seed % 9; ++n) {
      const Vec3 one = any_direction(seed, n);
      normals.push_back(seed % 3 == 0 ? glm::normalize(one + 1.2 * kZ) : one);
    }
    const Vec3 force = any_direction(seed, 99) * 4.0;
    // The twin nears its end by a part of what is left each round: near-parallel walls leave it a little short.
    CHECK(std::abs(outside_cone(force, normals) - slowly_outside(force, normals)) < 1e-3);
  }
}

TEST_CASE("contact cone: normals are those of the bone that is touched, and of no other") {
  PhantomSpec plate;
  plate.kind = PhantomKind::plate;
  plate.pitch = 0.25e-3;
  plate.extent = Vec3(8e-3, 8e-3, 8e-3);
  plate.thickness = 3e-3;
  const auto level = normals_at(plate, {Vec3(0.0, 0.0, 0.05e-3), Vec3(0.3e-3, 0.0, -0.4e-3)});  // one beside the face, one under it
  REQUIRE_FALSE(level.empty());
  for (const Vec3& n : level) CHECK(n.z > 1.0 - 1e-9);
  CHECK(normals_at(plate, {Vec3(0.0, 0.0, 1e-3)}).empty());     // in air
  CHECK(normals_at(plate, {Vec3(0.0, 0.0, -1.5e-3)}).empty());  // too deep to say which way is out
  plate.plate_normal = Vec3(0.4226183, 0.0, 0.9063078);
  const auto tilted = normals_at(plate, {Vec3(0.0)});
  REQUIRE_FALSE(tilted.empty());
  // Density is a ramp along the normal, but for the voxels at its ends: within a degree.
  for (const Vec3& n : tilted) CHECK(glm::dot(n, glm::normalize(plate.plate_normal)) > std::cos(std::numbers::pi / 180.0));
}

TEST_CASE("contact cone: in a pit floor and wall are distinguished, and a flipped force is outside") {
  PhantomSpec pit;
  pit.kind = PhantomKind::pit;
  pit.pitch = 0.25e-3;
  pit.extent = Vec3(12e-3, 12e-3, 10e-3);
  pit.thickness = 6e-3;
  pit.hole_depth = 3e-3;
  pit.hole_radius = 2e-3;
  const auto floor = normals_at(pit, {Vec3(0.0, 0.0, -3e-3)}), wall = normals_at(pit, {Vec3(2e-3, 0.0, -1.5e-3)});
  CHECK(has(floor, kZ, 0.999));
  CHECK_FALSE(has(floor, -kX, 0.5));
  CHECK(has(wall, -kX, 0.99));
  CHECK_FALSE(has(wall, kZ, 0.5));
  auto both = floor;
  both.insert(both.end(), wall.begin(), wall.end());
  const Vec3 force = 2.0 * kZ - 1.0 * kX;
  CHECK(outside_cone(force, both) < 0.02);
  CHECK(outside_cone(-force, both) > 2.0);
}
