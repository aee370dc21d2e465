#include "volumes/read/mesh_formats.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/random.h"

using namespace burrhole;

namespace {

SurfaceMesh cut(std::vector<Vec3> corners) {
  SurfaceMesh mesh{std::move(corners), {}};
  std::vector<std::uint32_t> all(mesh.positions.size());
  std::iota(all.begin(), all.end(), 0u);
  std::uint64_t steps = 0;
  CHECK(append_polygon(all, mesh, steps) == "");
  return mesh;
}

struct Areas {
  Vec3 vector{0.0};  ///< sum of the triangles' area vectors
  double sum = 0.0;  ///< sum of their areas
};

Areas areas(const SurfaceMesh& mesh) {
  Areas out;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = mesh.positions[mesh.indices[n]], b = mesh.positions[mesh.indices[n + 1]], c = mesh.positions[mesh.indices[n + 2]];
    const Vec3 area = 0.5 * glm::cross(b - a, c - a);
    out.vector += area;
    out.sum += glm::length(area);
  }
  return out;
}

}  // namespace

TEST_CASE("polygon: concave stars on any plane are covered once, without overlap") {
  constexpr std::uint64_t kSeed = 3;
  for (std::uint64_t n = 0; n < 200; ++n) {
    const int corners = 4 + static_cast<int>(40.0 * uniform01(kSeed, 3 * n));
    const Vec3 axis = glm::normalize(Vec3(uniform11(kSeed, 100 + n), uniform11(kSeed, 1000 + n), uniform11(kSeed, 2000 + n)));
    const Quat turn = rotation_from_z(axis);
    std::vector<Vec3> star;
    for (int m = 0; m < corners; ++m) {
      const double angle = 2.0 * std::numbers::pi * m / corners, r = 0.2 + uniform01(kSeed, 5000 + 100 * n + static_cast<std::uint64_t>(m));
      star.push_back(turn * Vec3(r * std::cos(angle), r * std::sin(angle), 0.0));
    }
    const SurfaceMesh mesh = cut(star);
    CHECK(mesh.indices.size() == 3 * (star.size() - 2));
    const Areas a = areas(mesh);
    // Equal only if no triangle is turned over; roundings of an area of order 1.
    CHECK(std::abs(glm::length(a.vector) - a.sum) < 1e-12);
    CHECK(glm::dot(a.vector, axis) > 0.0);
  }
}

TEST_CASE("polygon: straight corners, crossings and doubled corners end, with all corners used") {
  const SurfaceMesh straight = cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(std::abs(areas(straight).sum - 2.0) < 1e-12);
  for (const std::vector<Vec3>& bad : {std::vector<Vec3>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Vec3>(7, Vec3(1.0)),
                                       std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5, 0, 0}}}) {
    const SurfaceMesh mesh = cut(bad);
    CHECK(mesh.indices.size() == 3 * (bad.size() - 2));
    std::vector<bool> used(bad.size(), false);
    for (const std::uint32_t i : mesh.indices) used[i] = true;
    for (const bool u : used) CHECK(u);
  }
}

TEST_CASE("polygon: the largest comb of teeth is covered once") {
  std::vector<Vec3> comb;
  for (std::size_t n = 0; n + 2 < kMaxPolygonCorners; ++n) comb.emplace_back(static_cast<double>(n), n % 2 == 0 ? 1.0 : 5.0, 0.0);
  comb.emplace_back(static_cast<double>(kMaxPolygonCorners), 0.0, 0.0);
  comb.emplace_back(-1.0, 0.0, 0.0);
  const Areas a = areas(cut(comb));
  CHECK(std::abs(glm::length(a.vector) - a.sum) < 1e-9 * a.sum);
}

TEST_CASE("polygon: the steps are as many as the header says, and a file of crossed polygons is refused by them") {
  constexpr std::uint64_t kSeed = 4;
  const auto steps_of = [](const std::vector<Vec3>& corners, std::uint64_t before, std::string& error) {
    SurfaceMesh mesh{corners, {}};
    std::vector<std::uint32_t> all(corners.size());
    std::iota(all.begin(), all.end(), 0u);
    std::uint64_t steps = before;
    error = append_polygon(all, mesh, steps);
    return steps - before;
  };
  std::vector<Vec3> round, crossed;
  for (std::size_t n = 0; n < kMaxPolygonCorners; ++n) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / kMaxPolygonCorners;
    round.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    crossed.emplace_back(uniform01(kSeed, 2 * n), uniform01(kSeed, 2 * n + 1), 0.0);
  }
  std::string error;
  CHECK(steps_of({{0, 0, 0}, {1, 0, 0}, {0.1, 0.1, 0}, {0, 1, 0}}, 0, error) <= 20);  // each of 4 corners against 4, and itself
  // Every corner is an ear, so cutting one off m looks at m, and itself: the sum over m = 4 .. 256 of m + 1.
  CHECK(steps_of(round, 0, error) == 256 * 257 / 2 - 6 + 253);
  // At most each of m against m, and itself: the sum of m^2 + m is (n^3 + 3 n^2 + 2 n) / 3.
  const std::uint64_t n = kMaxPolygonCorners, most = (n * n * n + 3 * n * n + 2 * n) / 3;
  const std::uint64_t taken = steps_of(crossed, 0, error);
  CHECK(error == "");
  CHECK(taken > 256 * 257 / 2);  // harder than a round one
  CHECK(taken <= most);
  // Refused within one corner's worth once the file has used its steps up.
  CHECK(steps_of(crossed, kMaxPolygonSteps - 1000, error) <= 1000 + n * n + n);
  CHECK(error.find("take more than 1000000000 steps") != std::string::npos);
}
