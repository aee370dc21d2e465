#include "core/tool/surface_mesh.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/base/random.h"
#include "core/tool/join_rounded.h"
#include "tests/support/mesh_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// As STL has it: every triangle with vertices of its own.
SurfaceMesh as_soup(const SurfaceMesh& mesh) {
  SurfaceMesh soup;
  for (const std::uint32_t i : mesh.indices) {
    soup.indices.push_back(static_cast<std::uint32_t>(soup.positions.size()));
    soup.positions.push_back(mesh.positions[i]);
  }
  return soup;
}

SurfaceMesh without_triangles(SurfaceMesh mesh, std::size_t first, std::size_t count) {
  const auto begin = mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * first);
  mesh.indices.erase(begin, begin + static_cast<std::ptrdiff_t>(3 * count));
  return mesh;
}

std::string fault_of(const SurfaceMesh& mesh) { return mesh_error(mesh).value_or(""); }

const SurfaceMesh kBox = box_mesh({0.01, 0.02, 0.03});

}  // namespace

TEST_CASE("check_mesh: a box has no error and its volume, as a soup of triangles too") {
  for (const SurfaceMesh& mesh : {kBox, as_soup(kBox)}) {
    const MeshCheck check = check_mesh(mesh);
    CHECK(check.triangles == 12);
    CHECK(check.open_edges == 0);
    CHECK(check.parts == 1);
    CHECK(std::abs(check.volume - 48e-6) < 1e-18);  // a few roundings of 48e-6
    CHECK(fault_of(mesh) == "");
  }
  const SurfaceMesh welded = weld(as_soup(kBox));
  CHECK(welded.positions.size() == 8);
  CHECK(check_mesh(welded).volume == check_mesh(as_soup(kBox)).volume);
}

TEST_CASE("check_mesh: the volume of a sphere of chords tends to the ball's from below") {
  const double ball = 4.0 / 3.0 * std::numbers::pi * 1e-6;
  const double coarse = ball - check_mesh(sphere_mesh({1, 2, 3}, 0.01, 3)).volume,
               fine = ball - check_mesh(sphere_mesh({1, 2, 3}, 0.01, 4)).volume;
  CHECK(fine > 0.0);
  CHECK(std::abs(coarse / fine - 4.0) < 0.1);  // second order in the edge; the next order is (edge / radius)^2 = 2 % of it
}

TEST_CASE("mesh_error: holes are counted and measured") {
  // A face of 20 x 40 mm missing: its rim is 120 mm. One triangle more on the far side: 20 + 40 + its diagonal.
  CHECK(fault_of(without_triangles(kBox, 0, 2)) ==
        "open: 4 edges without a neighbour in 1 hole, the longest 120 mm around; close them in a mesh editor");
  CHECK(fault_of(without_triangles(without_triangles(kBox, 2, 1), 0, 2)) ==
        "open: 7 edges without a neighbour in 2 holes, the longest 120 mm around; close them in a mesh editor");
}

TEST_CASE("mesh_error: inside-out, wound both ways, doubled and flat surfaces are distinguished") {
  CHECK(fault_of(inside_out(kBox)) == "inside-out: its normals point inwards; flip them (signed volume -48 cm3)");
  SurfaceMesh one_turned = kBox;
  std::swap(one_turned.indices[0], one_turned.indices[1]);
  CHECK(fault_of(one_turned) ==
        "wound both ways: the triangles at 3 edges do not agree on which side is outside; turn all normals outwards");
  SurfaceMesh doubled = kBox;
  doubled.indices.insert(doubled.indices.end(), {0, 2, 1});
  CHECK(fault_of(doubled) ==
        "not a solid: 3 edges are shared by more than two triangles; delete doubled faces and part bodies that touch there");
  const SurfaceMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 1}};
  CHECK(fault_of(flat) == "flat: it encloses no volume; give a closed surface");
}

TEST_CASE("mesh_error: a part wound inward is a cavity inside another and an error outside") {
  const SurfaceMesh hole = inside_out(box_mesh({0.005, 0.005, 0.005}));
  CHECK(fault_of(joined(kBox, hole)) == "");
  CHECK(check_mesh(joined(kBox, hole)).parts == 2);
  const SurfaceMesh apart = inside_out(box_mesh({0.005, 0.005, 0.005}, {Quat(0.0, 0.0, 0.0, 1.0), {0.1, 0.001, 0.002}}));
  CHECK(fault_of(joined(kBox, apart)) ==
        "inside-out in 1 of 2 parts: normals point inwards; flip them (the first has a signed volume of -1 cm3 and no solid round it)");
  // Left of the solid, too, where no ray has entered yet.
  const SurfaceMesh left = inside_out(box_mesh({0.005, 0.005, 0.005}, {Quat(0.0, 0.0, 0.0, 1.0), {-0.1, 0.001, 0.002}}));
  CHECK(fault_of(joined(kBox, left)) != "");
}

TEST_CASE("mesh_error: triangles with fewer than three places do no harm, thin ones hold their neighbours") {
  SurfaceMesh mesh = kBox;
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 3, 3, 3});
  CHECK(check_mesh(mesh).degenerate == 2);
  CHECK(fault_of(mesh) == "");
  // A vertex in the middle of edge 0-1 of one triangle, closed by a triangle without area.
  mesh = kBox;
  mesh.positions.push_back(0.5 * (mesh.positions[0] + mesh.positions[1]));
  mesh.indices.erase(mesh.indices.begin(), mesh.indices.begin() + 3);  // 0, 2, 1
  mesh.indices.insert(mesh.indices.end(), {0, 2, 8, 8, 2, 1});
  CHECK(fault_of(mesh) == "open: 3 edges without a neighbour in 1 hole, the longest 40 mm around; close them in a mesh editor");
  mesh.indices.insert(mesh.indices.end(), {0, 8, 1});
  CHECK(fault_of(mesh) == "");
}

TEST_CASE("mesh_error: broken lists are errors, not crashes") {
  CHECK(fault_of({}) == "no triangles");
  CHECK(fault_of({{{0, 0, 0}}, {0, 0}}) == "an index list whose length is not a multiple of three");
  CHECK(fault_of({{{0, 0, 0}}, {0, 0, 7}}) == "index 7 into 1 vertices");
  CHECK(fault_of({{{0, 0, std::numeric_limits<double>::quiet_NaN()}}, {0, 0, 0}}) == "a vertex that is not finite");
}

TEST_CASE("join_rounded: copies of a vertex that differ by roundings close, and no vertex moves farther than the tolerance") {
  const SurfaceMesh sphere = sphere_mesh({0.03, -0.01, 0.002}, 0.01, 4);
  const double tolerance = 0.04 * 0x1p-22;  // the largest coordinate is that of the pole at x = 0.04, within 1 %
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SurfaceMesh noisy = as_soup(sphere);
    std::uint64_t n = 0;
    for (Vec3& p : noisy.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] += 0.25 * tolerance * uniform11(seed, n++);
    // Sabotage: without the join every edge is open.
    CHECK(check_mesh(noisy).open_edges > sphere.indices.size() / 2);
    const SurfaceMesh before = noisy;
    const RoundingJoin join = join_rounded(noisy);
    CHECK(fault_of(noisy) == "");
    CHECK(noisy.positions.size() == sphere.positions.size());
    CHECK(join.joined == before.positions.size() - sphere.positions.size());
    CHECK(std::abs(join.tolerance / tolerance - 1.0) < 0.01);
    double most = 0.0;
    for (std::size_t i = 0; i < before.indices.size(); ++i)
      most = std::max(most, glm::distance(noisy.positions[noisy.indices[i]], before.positions[before.indices[i]]));
    CHECK((most > 0.0 && most <= join.tolerance));
  }
}

TEST_CASE("join_rounded: zero and -2.9e-16 are one place; gaps beyond the tolerance stay open, and a closed mesh stays as it is") {
  SurfaceMesh box = box_mesh({0.01, 0.02, 0.03}, {Quat(0.0, 0.0, 0.0, 1.0), {0.01, 0.0, 0.0}}), gap = box;
  // One triangle has copies of its corners, moved along x.
  const auto move_copies = [](SurfaceMesh& mesh, double by) {
    for (std::size_t i = 0; i < 3; ++i) {
      mesh.positions.push_back(mesh.positions[mesh.indices[i]] + Vec3(by, 0.0, 0.0));
      mesh.indices[i] = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
  };
  move_copies(gap, -2.9e-16);
  CHECK(check_mesh(gap).open_edges == 6);
  RoundingJoin join = join_rounded(gap);
  CHECK(join.joined == 3);
  CHECK(join.text() == "3 vertices of open edges lie within 7.2e-06 mm of another, a rounding of 32-bit coordinates: joined");
  CHECK(fault_of(gap) == "");
  // Sabotage: farther than the tolerance, 2^-22 of 30 mm.
  gap = box;
  move_copies(gap, -1.01 * 0.03 * 0x1p-22);
  CHECK(join_rounded(gap).joined == 0);
  CHECK(check_mesh(gap).open_edges == 6);
  gap = box;
  move_copies(gap, -0.99 * 0.03 * 0x1p-22);
  CHECK(join_rounded(gap).joined == 3);
  CHECK(fault_of(gap) == "");
  // Closed parts that nearly touch, and vertices within the tolerance in a closed surface.
  SurfaceMesh closed = joined(kBox, box_mesh({0.01, 0.02, 0.03}, {Quat(0.0, 0.0, 0.0, 1.0), {0.02 + 1e-12, 0.0, 0.0}}));
  const SurfaceMesh same = closed;
  CHECK(join_rounded(closed).joined == 0);
  CHECK(closed.positions == same.positions);
  CHECK(closed.indices == same.indices);
  SurfaceMesh nothing{{Vec3(0.0), Vec3(0.0)}, {0, 1, 0}};
  CHECK(join_rounded(nothing).joined == 0);
}
