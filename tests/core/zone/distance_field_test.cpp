#include "core/zone/distance_field.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

namespace burrhole::test {
namespace {

using Body = std::function<bool(const Vec3& metres)>;

DistanceField::Members centres_in(const Body& body, const Vec3& edges) {
  return [body, edges](const VoxelBox& box, std::span<std::uint8_t> inside) {
    std::size_t n = 0;
    for_each_voxel(box, [&](const Vec3i& v) { inside[n++] = body(Vec3(v) * edges) ? 1 : 0; });
  };
}

/// @returns a number in [0, 1) of a voxel.
double chance(const Vec3i& v, std::uint64_t salt) {
  std::uint64_t x = salt;
  for (int axis = 0; axis < 3; ++axis) {
    x ^= static_cast<std::uint64_t>(v[axis] + 1000);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x ^= x >> 27;
  }
  return static_cast<double>(x >> 11) * 0x1.0p-53;
}

/// Plain twin: every voxel against every voxel of the other kind.
double twin(const Vec3i& at, const VoxelBox& all, const Vec3& edges, const Body& body, double reach) {
  const bool in = body(Vec3(at) * edges);
  const double half = (edges.x + edges.y + edges.z) / 6.0;
  double nearest = std::numeric_limits<double>::infinity();
  for_each_voxel(all, [&](const Vec3i& v) {
    if (body(Vec3(v) * edges) != in) nearest = std::min(nearest, glm::length(Vec3(v - at) * edges));
  });
  return std::clamp(in ? half - nearest : nearest - half, -reach, reach);
}

DistanceField field_of(const VoxelBox& box, const Vec3& edges, double reach, const Body& body) {
  auto made = DistanceField::create(box, edges, reach, centres_in(body, edges));
  REQUIRE(made);
  return std::move(made).value();
}

double largest_error(const DistanceField& field, const Vec3& edges, const Body& body) {
  const Vec3i margin(glm::ceil(Vec3(field.reach() + std::min({edges.x, edges.y, edges.z})) / edges));
  const VoxelBox all{field.box().lo - margin, field.box().hi + margin};
  double out = 0.0;
  for_each_voxel(field.box(), [&](const Vec3i& v) {
    out = std::max(out, std::abs(static_cast<double>(field.value(v)) - twin(v, all, edges, body, field.reach())));
  });
  return out;
}

}  // namespace

TEST_CASE("distance field: a plain twin that tries all voxels finds the same, on scattered voxels, with unequal edges") {
  // Floats of squares: a relative rounding of 2^-24 in each of three sweeps and one of the result, of at most the reach of 2 mm: 5e-10 m.
  constexpr double kRounding = 5e-10;
  std::mt19937 random(20261127);
  MESSAGE("seed 20261127");
  for (const Vec3& edges : {Vec3(0.25e-3), Vec3(0.2e-3, 0.35e-3, 0.5e-3)})
    for (const double share : {0.003, 0.2, 0.9}) {
      const auto salt = static_cast<std::uint64_t>(random());
      const Body scattered = [&edges, share, salt](const Vec3& p) {
        const Vec3i v(glm::round(p / edges));
        return chance(v, salt) < share;
      };
      const VoxelBox box{Vec3i(-3, -4, -2), Vec3i(4, 3, 3)};
      const DistanceField field = field_of(box, edges, 2e-3, scattered);
      CHECK(largest_error(field, edges, scattered) < kRounding);
      // The sabotage: a transform that leaves out the last axis is found.
      const Body flat = [&scattered, &edges](const Vec3& p) { return scattered(Vec3(p.x, p.y, edges.z)); };
      CHECK(largest_error(field_of(box, edges, 2e-3, flat), edges, scattered) > kRounding);
    }
}

TEST_CASE("distance field: plane and ball follow their closed forms within the bound of voxels, with their directions") {
  const Vec3 edges(0.25e-3);
  const double h = 0.25e-3, bound = std::sqrt(3.0) * h;
  const VoxelBox box{Vec3i(-20), Vec3i(21)};
  SUBCASE("a level face halfway between two layers is exact, also between voxels, and clipped at the reach") {
    const DistanceField field = field_of(box, edges, 3e-3, [h](const Vec3& p) { return p.z < -0.5 * h; });
    for (const double z : {-7.3, -2.0, -0.5, 0.0, 0.26, 5.9, 11.0}) {
      const NearestZone found = field.at(Vec3(1.3, -4.7, z));
      CHECK(std::abs(found.distance - std::min((z + 0.5) * h, 3e-3)) < 1e-6 * h);  // floats
      CHECK(glm::length(found.away - Vec3(0.0, 0.0, 1.0)) < 1e-6);
    }
    CHECK(field.at(Vec3(0.0, 0.0, 19.0)).distance == doctest::Approx(3e-3));
    CHECK(field.at(Vec3(0.0, 0.0, 19.0)).away == Vec3(0.0));
  }
  SUBCASE("oblique plane") {
    const Vec3 normal = glm::normalize(Vec3(0.4, -0.3, 0.85));
    const DistanceField field = field_of(box, edges, 3e-3, [&](const Vec3& p) { return glm::dot(p, normal) < 0.1e-3; });
    for_each_voxel(box, [&](const Vec3i& v) {
      const double truth = glm::dot(Vec3(v) * edges, normal) - 0.1e-3;
      if (std::abs(truth) < 2.5e-3) REQUIRE(std::abs(static_cast<double>(field.value(v)) - truth) < bound);
    });
    // A staircase of slopes of up to one in every axis: the direction is that of the nearest voxels, over more than a voxel's distance.
    CHECK(glm::dot(field.at(normal * 10.0).away, normal) > 0.9);
  }
  SUBCASE("ball of 2 mm, inside and outside") {
    const DistanceField field = field_of(box, edges, 4e-3, [](const Vec3& p) { return glm::length(p) < 2e-3; });
    double largest = 0.0;
    for_each_voxel(box, [&](const Vec3i& v) {
      const double truth = glm::length(Vec3(v) * edges) - 2e-3;
      if (truth < 3.5e-3) largest = std::max(largest, std::abs(static_cast<double>(field.value(v)) - truth));
    });
    CHECK(largest < bound);
    CHECK(largest > 0.05 * h);  // it is a ball of voxels
  }
}

TEST_CASE("distance field: the error of a ball falls with the edge of the voxels") {
  double before = 1.0;
  for (const double h : {0.4e-3, 0.2e-3, 0.1e-3}) {
    const int n = static_cast<int>(3e-3 / h);
    const DistanceField field =
        field_of({Vec3i(-n), Vec3i(n + 1)}, Vec3(h), 2e-3, [](const Vec3& p) { return glm::length(p - Vec3(0.03e-3)) < 1.5e-3; });
    double sum = 0.0;
    int count = 0;
    for_each_voxel(field.box(), [&](const Vec3i& v) {
      const double truth = glm::length(Vec3(v) * h - Vec3(0.03e-3)) - 1.5e-3;
      if (std::abs(truth) > 1e-3) return;
      sum += std::abs(static_cast<double>(field.value(v)) - truth);
      ++count;
    });
    const double mean = sum / count;
    MESSAGE("voxels of " << h * 1e3 << " mm: mean error " << mean * 1e3 << " mm");
    CHECK(mean < 0.5 * h);
    CHECK(mean < 0.7 * before);
    before = mean;
  }
}

TEST_CASE("distance field: without a member all is at the reach; with members alone all is inside; wrong sizes are refused") {
  const VoxelBox box{Vec3i(0), Vec3i(5, 1, 3)};
  const DistanceField none = field_of(box, Vec3(1e-3), 2e-3, [](const Vec3&) { return false; });
  CHECK_FALSE(none.has_members());
  CHECK(none.at(Vec3(2.5, 0.0, 1.5)).distance == 2e-3f);
  const DistanceField all = field_of(box, Vec3(1e-3), 2e-3, [](const Vec3&) { return true; });
  CHECK(all.has_members());
  CHECK(all.at(Vec3(2.5, 0.0, 1.5)).distance == -2e-3f);
  CHECK(all.knows(Vec3(4.0, 0.0, 2.0)));
  CHECK_FALSE(all.knows(Vec3(4.01, 0.0, 2.0)));
  CHECK_FALSE(all.knows(Vec3(std::nan(""), 0.0, 2.0)));
  const auto refused = [](const VoxelBox& of, const Vec3& edges, double reach) {
    const auto made = DistanceField::create(of, edges, reach, [](const VoxelBox&, std::span<std::uint8_t>) {});
    return !made && made.error().code == ErrorCode::out_of_range;
  };
  CHECK(refused({}, Vec3(1e-3), 2e-3));
  CHECK(refused(box, Vec3(1e-3, 0.0, 1e-3), 2e-3));
  CHECK(refused(box, Vec3(1e-3), std::nan("")));
  CHECK(refused(box, Vec3(1e-9), 1.0));
}

TEST_CASE("distance to a tube: beside it, beyond its ends, on its axis; a tube without length is a ball") {
  const Vec3 from(0.0, -5e-3, 0.0), to(0.0, 5e-3, 0.0);
  const NearestZone beside = distance_to_tube(from, to, 2e-3, Vec3(3e-3, 1e-3, 4e-3));
  CHECK(beside.distance == doctest::Approx(3e-3));
  CHECK(glm::length(beside.away - Vec3(0.6, 0.0, 0.8)) < 1e-12);
  CHECK(distance_to_tube(from, to, 2e-3, Vec3(0.0, 9e-3, 3e-3)).distance == doctest::Approx(3e-3));
  CHECK(distance_to_tube(from, to, 2e-3, Vec3(0.0, 1e-3, 0.0)).distance == doctest::Approx(-2e-3));
  CHECK(distance_to_tube(from, to, 2e-3, Vec3(0.0, 1e-3, 0.0)).away == Vec3(0.0));
  CHECK(distance_to_tube(from, from, 2e-3, Vec3(0.0, -5e-3, 7e-3)).distance == doctest::Approx(5e-3));
}

}  // namespace burrhole::test
