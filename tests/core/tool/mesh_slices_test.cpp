#include "core/tool/mesh_slices.h"

#include <doctest/doctest.h>

#include "core/base/random.h"
#include "core/base/units.h"
#include "tests/support/mesh_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

std::vector<std::uint8_t> inside_of(const SurfaceMesh& mesh, const PointLattice& lattice) {
  std::vector<std::uint8_t> all;
  for_each_slice(mesh, lattice, [&](int, std::span<const std::uint8_t> inside) {
    all.insert(all.end(), inside.begin(), inside.end());
    return true;
  });
  return all;
}

std::size_t count_of(const std::vector<std::uint8_t>& inside) {
  return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), std::uint8_t{1}));
}

/// Lattice points at which the slices and the sum of solid angles disagree.
std::size_t differences(const SurfaceMesh& mesh, const SurfaceMesh& twin, const PointLattice& lattice) {
  const std::vector<std::uint8_t> inside = inside_of(mesh, lattice);
  std::size_t at = 0, wrong = 0;
  for_each_voxel({Vec3i(0), lattice.dims}, [&](const Vec3i& v) {
    const bool expected = winding_number(twin, lattice.origin + lattice.pitch * Vec3(v)) > 0.5;
    wrong += expected != (inside[at++] == 1) ? 1 : 0;
  });
  return wrong;
}

Pose tilted(const Vec3& shift) { return {glm::angleAxis(37 * kDegree, glm::normalize(Vec3(1, 2, 3))), shift}; }

}  // namespace

TEST_CASE("mesh slices: inside agrees with the generalised winding number everywhere") {
  const PointLattice lattice{{-1.603, -1.597, -1.611}, 0.2, {17, 17, 17}};
  const SurfaceMesh shell = joined(sphere_mesh({0, 0, 0}, 1.4, 2), inside_out(sphere_mesh({0.1, 0, 0}, 0.9, 2)));
  const SurfaceMesh overlap = joined(box_mesh({0.5, 0.7, 0.9}, tilted({0.2, 0, 0})), box_mesh({0.8, 0.4, 0.6}, tilted({-0.3, 0.1, 0.2})));
  CHECK(differences(shell, shell, lattice) == 0);
  CHECK(differences(overlap, overlap, lattice) == 0);
  // The check can fail: one triangle turned round is seen.
  SurfaceMesh broken = shell;
  std::swap(broken.indices[0], broken.indices[1]);
  CHECK(differences(broken, shell, lattice) > 0);
}

TEST_CASE("mesh slices: rows through vertices, edges and faces neither leak nor count twice") {
  // Every lattice row meets the box's faces, edges, diagonals and corners exactly. Half-open: of 0 .. 8 on each axis, 8 steps are inside.
  const SurfaceMesh box = box_mesh({4, 4, 4});
  const PointLattice lattice{{-6, -6, -6}, 1.0, {13, 13, 13}};
  const std::vector<std::uint8_t> inside = inside_of(box, lattice);
  CHECK(count_of(inside) == 8 * 8 * 8);
  // The same box of many vertices, all on lattice points.
  const SurfaceMesh octahedron{{{4, 0, 0}, {-4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 4}, {0, 0, -4}},
                               {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5}};
  REQUIRE_FALSE(mesh_error(octahedron));
  const std::vector<std::uint8_t> diamond = inside_of(octahedron, lattice);
  std::size_t at = 0;
  for_each_voxel({Vec3i(0), lattice.dims}, [&](const Vec3i& v) {
    const int distance = std::abs(v.x - 6) + std::abs(v.y - 6) + std::abs(v.z - 6);
    CAPTURE(v.x);
    CAPTURE(v.y);
    CAPTURE(v.z);
    if (distance != 4) CHECK(diamond[at] == (distance < 4 ? 1 : 0));  // on the surface either is right
    ++at;
  });
}

TEST_CASE("mesh slices: two boxes that share a face fill space exactly once") {
  // A point on the common face belongs to one of them: tilted, so that ties are a matter of rounding, and straight, so that they are exact.
  for (const Pose& pose : {Pose{}, tilted({0.1, 0.2, 0.3})}) {
    const auto half = [&](double x) { return box_mesh({1, 1.5, 1}, {pose.rotation, pose * Vec3(x, 0, 0)}); };
    const PointLattice lattice{{-4, -4, -4}, 0.25, {33, 33, 33}};
    const auto left = inside_of(half(-1), lattice), right = inside_of(half(1), lattice),
               both = inside_of(joined(half(-1), half(1)), lattice);
    std::size_t twice = 0, lost = 0;
    for (std::size_t n = 0; n < both.size(); ++n) {
      twice += left[n] && right[n] ? 1 : 0;
      lost += both[n] != (left[n] || right[n]) ? 1 : 0;
    }
    CHECK(twice == 0);
    CHECK(lost == 0);
    // The whole is 4 x 3 x 2; the count's error is of the order of surface * pitch / sqrt(count of surface cells): well under 5 %.
    CHECK(std::abs(static_cast<double>(count_of(both)) * 0.25 * 0.25 * 0.25 - 24.0) < 0.05 * 24.0);
  }
}

TEST_CASE("mesh slices: stop on request, and lattices beside the mesh are empty") {
  int calls = 0;
  for_each_slice(box_mesh({1, 1, 1}), {Vec3(-2), 0.5, {9, 9, 9}}, [&](int, std::span<const std::uint8_t>) { return ++calls < 3; });
  CHECK(calls == 3);
  CHECK(count_of(inside_of(box_mesh({1, 1, 1}), {Vec3(50), 0.5, {9, 9, 9}})) == 0);
  CHECK(count_of(inside_of(box_mesh({1, 1, 1}), {Vec3(-0.5), 0.1, {9, 9, 9}})) == 729);
}

TEST_CASE("mesh slices: windings left of points agree with the solid angles at random points") {
  const SurfaceMesh mesh = joined(box_mesh({1, 0.8, 0.6}, tilted({0.1, 0, 0})), sphere_mesh({0.5, 0.2, 0}, 0.7, 1));
  constexpr std::uint64_t kSeed = 11;
  std::vector<Vec3> points;
  for (std::uint64_t n = 0; n < 500; ++n)
    points.push_back(1.5 * Vec3(uniform11(kSeed, 3 * n), uniform11(kSeed, 3 * n + 1), uniform11(kSeed, 3 * n + 2)));
  const std::vector<int> found = windings_left_of(mesh, points);
  for (std::size_t n = 0; n < points.size(); ++n) CHECK(found[n] == static_cast<int>(std::lround(winding_number(mesh, points[n]))));
}
