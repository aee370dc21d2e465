#include "core/mesh/surface_offset.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/mesh_census.h"
#include "tests/core/mesh/mesh_checks.h"
#include "tests/core/mesh/pivot_twin.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr BallMeshConfig kSubvoxel{.subvoxel = true};

/// Density ramps whose 0.5 level encloses a known volume [voxel^3].
struct Body {
  std::string name;
  Vec3i edge;
  std::function<double(const Vec3&)> distance;
  double volume;
};

double outside_box(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  return std::max({lo.x - p.x, p.x - hi.x, lo.y - p.y, p.y - hi.y, lo.z - p.z, p.z - hi.z});
}

/// The tolerance of 1 % has two known parts. Chords of a mesh, and the trilinear density between its centres, lie inside a convex face: about
/// 1 % of the volume of a ball at 10 voxels of radius, in proportion to 1 / radius^2. And the 0.5 level rounds a sharp edge: by 0.4 voxel^2.
std::vector<Body> bodies() {
  const double pi = std::numbers::pi;
  const Vec3 middle(19.3, 18.8, 19.1), lo(2.3, 2.6, 2.2), hi(57.4, 58.1, 18.6), block_lo(1.4), block_hi(38.7);
  const double slab = (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z), hole = 8.4;
  return {
      {"ball of radius 15", Vec3i(40), [=](const Vec3& p) { return glm::length(p - middle) - 15.0; }, 4.0 / 3.0 * pi * 15.0 * 15.0 * 15.0},
      {"ball of radius 12", Vec3i(40), [=](const Vec3& p) { return glm::length(p - middle) - 12.0; }, 4.0 / 3.0 * pi * 12.0 * 12.0 * 12.0},
      {"ball of radius 10", Vec3i(40), [=](const Vec3& p) { return glm::length(p - middle) - 10.0; }, 4.0 / 3.0 * pi * 1000.0},
      {"cavity in a block", Vec3i(40),
       [=](const Vec3& p) { return std::max(10.0 - glm::length(p - middle), outside_box(p, block_lo, block_hi)); },
       std::pow(37.3, 3) - 4.0 / 3.0 * pi * 1000.0},
      {"slab", Vec3i(60, 60, 22), [=](const Vec3& p) { return outside_box(p, lo, hi); }, slab},
      {"thinner slab", Vec3i(50, 50, 20), [=](const Vec3& p) { return outside_box(p, Vec3(2.3, 2.6, 4.2), Vec3(47.4, 48.1, 14.9)); },
       45.1 * 45.5 * 10.7},
      {"slab with a round hole", Vec3i(60, 60, 22),
       [=](const Vec3& p) { return std::max(outside_box(p, lo, hi), hole - std::hypot(p.x - 29.4, p.y - 30.1)); },
       slab - pi * hole * hole * (hi.z - lo.z)},
  };
}

/// @returns how many triangles have another side outside after their vertices were moved.
std::size_t turned_over(const BallMesh& mesh) {
  const HalfEdgeMesh& half_edges = mesh.half_edges();
  std::size_t count = 0;
  for (HalfEdgeMesh::Id t = 0; t < half_edges.triangle_slots(); ++t) {
    if (!half_edges.has_triangle(t)) continue;
    std::array<Vec3, 3> moved, centres;
    for (HalfEdgeMesh::Id n = 0; n < 3; ++n) {
      moved[n] = mesh.position(3 * t + n);
      centres[n] = Vec3(half_edges.voxel(half_edges.origin(3 * t + n)));
    }
    const auto normal = [](const std::array<Vec3, 3>& p) { return glm::cross(p[1] - p[0], p[2] - p[0]); };
    count += glm::dot(normal(moved), normal(centres)) <= 0.0 ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("surface offset: to a plane it is the distance along the normal") {
  for (const Vec3& normal : {Vec3(0.0, 0.0, 1.0), Vec3(0.6, 0.0, 0.8), glm::normalize(Vec3(1.0, -2.0, 3.0))}) {
    const MeshBone bone = ramp(Vec3i(11), [&](const Vec3& p) { return glm::dot(normal, p - Vec3(5.0)) - 0.3; });
    const auto offset = offset_to_surface(bone.block(), bone.box.lo + 5);
    REQUIRE(offset.has_value());
    // Trilinear between clamped values is within a tenth of the ramp where the plane is not along an axis.
    CHECK(glm::length(*offset - 0.3 * normal) < 0.1);
    if (normal.z == 1.0) CHECK(glm::length(*offset - 0.3 * normal) < 1e-6);
  }
}

TEST_CASE("surface offset: none in the middle of a symmetric wall, none far inside") {
  const MeshBone wall = whole_voxels(Vec3i(7), [](const Vec3i& v) { return v.z == 3; });
  CHECK_FALSE(offset_to_surface(wall.block(), wall.box.lo + 3));
  const MeshBone deep = ramp(Vec3i(20), [](const Vec3& p) { return 0.001 * (p.x - 300.0); });
  CHECK_FALSE(offset_to_surface(deep.block(), deep.box.lo + 10));
}

TEST_CASE("surface offset: the moved mesh encloses the volume of the 0.5 level within 1 %") {
  for (const Body& body : bodies()) {
    INFO(body.name);
    const MeshBone bone = ramp(body.edge, body.distance);
    const BallMesh mesh = make_mesh(bone, kSubvoxel);
    const MeshCensus census = take_census(mesh);
    const double error = census.volume / body.volume - 1.0, at_centres = take_census(make_mesh(bone)).volume / body.volume - 1.0;
    MESSAGE(body.name, ": ", 100.0 * error, " %; at the centres ", 100.0 * at_centres, " %");
    CHECK(std::abs(error) < 0.01);
    CHECK(std::abs(at_centres) > 0.01);  // sabotage: without offsets
    CHECK(mesh_error_of(mesh, bone) == "");
    CHECK(turned_over(mesh) == 0);
    for (HalfEdgeMesh::Id h = 0; h < 3 * mesh.half_edges().triangle_slots(); ++h)
      CHECK(glm::length(mesh.offset(h)) <= static_cast<float>(kLongestOffset));
  }
}

TEST_CASE("surface offset: after an update every vertex is where a full pivoting has it, bit for bit") {
  const auto body = bodies().back();
  MeshBone bone = ramp(body.edge, body.distance);
  BallMesh mesh = make_mesh(bone, kSubvoxel);
  for (int step = 0; step < 5; ++step) {
    const Vec3 burr = Vec3(bone.box.lo) + Vec3(20.0 + 0.4 * step, 30.0, 15.0 - 1.3 * step);
    VoxelBox changed;
    for_each_voxel(bone.box, [&](const Vec3i& v) {
      const auto left = static_cast<float>(std::clamp(0.5 + glm::length(Vec3(v) - burr) - 5.0, 0.0, 1.0));
      float& density = bone.density[bone.box.offset_of(v)];
      if (left >= density) return;
      density = left;
      changed.include(v);
    });
    const std::uint64_t moved = mesh.work().vertices_moved;
    mesh.update(bone.block(), changed);
    CHECK(mesh.work().vertices_moved - moved < 1200);
    const BallMesh full = make_mesh(bone, kSubvoxel);
    CHECK(moved_triangles(mesh) == moved_triangles(full));
  }
}

TEST_CASE("surface offset: a wall of one voxel has its thickness, as each side has a vertex of its own") {
  const MeshBone bone =
      whole_voxels(Vec3i(14, 15, 7), [](const Vec3i& v) { return v.z == 3 && v.x > 0 && v.x < 13 && v.y > 0 && v.y < 14; });
  const BallMesh mesh = make_mesh(bone, kSubvoxel);
  CHECK(std::abs(take_census(make_mesh(bone)).volume) < 1e-9);
  // The 0.5 level of whole voxels is half a voxel from the centres. Inside the rim, 9 x 10 voxels, the thickness is 1. Rim voxels have one fan
  // and one vertex: from there to the rim the thickness falls to 0, so half of 11 x 12 - 9 x 10 is left, and what the rim moves outwards.
  const double volume = take_census(mesh).volume;
  MESSAGE("volume of the wall: ", volume, " voxel^3");
  CHECK(volume > 90.0 + 0.5 * 42.0);
  CHECK(volume < 12.0 * 13.0);
  const MeshCheck check = check_mesh(mesh.surface());
  CHECK(check.open_edges == 0);
  CHECK(check.flipped_edges == 0);
  CHECK(check.non_manifold_edges == 2);  // the diagonals that cut off two corners: both ends are at the rim
  CHECK(std::abs(check.volume - volume) < 1e-6);
  CHECK(turned_over(mesh) == 0);
}

TEST_CASE("surface offset: of shapes that touch and of thin walls, changes keep the offsets of a full pivoting") {
  for (const MeshShape& shape : small_shapes(5)) {
    INFO(shape.name);
    MeshBone bone = shape.bone;
    BallMesh mesh = make_mesh(bone, kSubvoxel);
    for (const Vec3i& voxel : shuffled(bone.solid_voxels(), 3)) {
      bone.set(voxel, false);
      mesh.update(bone.block(), {voxel, voxel + 1});
      if (voxel.x % 2 == 0) continue;
      CHECK(moved_triangles(mesh) == moved_triangles(make_mesh(bone, kSubvoxel)));
      const MeshCheck check = check_mesh(mesh.surface());
      CHECK(check.flipped_edges == 0);
      CHECK(check.open_edges == 0);
    }
  }
}
