#include "core/mesh/ball_tables.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/core/mesh/pivot_twin.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Bone of the solid corners of one cell.
MeshBone cell_bone(unsigned corners) {
  return whole_voxels(Vec3i(2), [&](const Vec3i& v) { return (corners >> (v.x + 2 * v.y + 4 * v.z) & 1u) != 0; });
}

}  // namespace

TEST_CASE("ball tables: a corner is on the ball or more than a hundredth of a voxel from it") {
  double nearest = 1.0;
  for (unsigned a = 0; a < 8; ++a)
    for (unsigned b = 0; b < 8; ++b)
      for (unsigned c = 0; c < 8; ++c) {
        const auto ball = ball_centre({Vec3(cell_corner(a)), Vec3(cell_corner(b)), Vec3(cell_corner(c))});
        CHECK(ball.has_value() == (a != b && b != c && a != c));  // every triangle of corners lets the ball rest on it
        if (!ball) continue;
        for_each_voxel({Vec3i(-3), Vec3i(5)}, [&](const Vec3i& v) {
          const double gap = std::abs(glm::length(Vec3(v) - *ball) - kBallRadius);
          if (gap > 1e-9) nearest = std::min(nearest, gap);
        });
      }
  MESSAGE("least distance of another centre from the ball: ", nearest, " voxel");
  CHECK(nearest > 0.01);
}

TEST_CASE("ball tables: no ball that is as large as a circle through three corners has another centre in it, unless in its cell") {
  // What makes the tables finite: from the middle of a cell outwards, all other centres are at least 1 away.
  for_each_voxel({Vec3i(0), Vec3i(9)}, [](const Vec3i& eighths) {
    for_each_voxel({Vec3i(-2), Vec3i(4)}, [&](const Vec3i& v) {
      if (!VoxelBox{Vec3i(0), Vec3i(2)}.contains(v)) CHECK(glm::length(Vec3(v) - 0.125 * Vec3(eighths)) >= 1.0);
    });
  });
}

TEST_CASE("ball tables: any radius between sqrt(3)/2 and 1 gives the same triangles; beyond 1 it does not") {
  bool differs = false;
  for (const MeshShape& shape : small_shapes(31)) {
    const PlainTriangles triangles = twin_triangles(shape.bone);
    INFO(shape.name);
    CHECK(!(triangles.empty() && shape.bone.surface_voxels().size() > 50));
    for (const double radius : {0.867, 0.9, 0.96, 0.999}) CHECK(twin_triangles(shape.bone, radius) == triangles);
    differs = differs || twin_triangles(shape.bone, 1.05) != triangles;
  }
  CHECK(differs);  // sabotage
}

TEST_CASE("ball tables: each of the 256 cells, alone in empty space, has the triangles of the twin and is closed") {
  const BallTables tables;
  for (unsigned corners = 0; corners < 256; ++corners) {
    const MeshBone bone = cell_bone(corners);
    const PlainTriangles expected = twin_triangles(bone);
    const PlainTopology topology = twin_topology(expected);
    CAPTURE(corners);
    CHECK(topology.unpaired == 0);
    CHECK(triangles_of(make_mesh(bone)) == expected);
    for (unsigned n = 0; n < tables.cell(corners).count; ++n) {
      const CellTriangle& t = tables.cell(corners).triangles[n];
      CHECK(expected.contains(
          plain_triangle(bone.box.lo + cell_corner(t[0]), bone.box.lo + cell_corner(t[1]), bone.box.lo + cell_corner(t[2]))));
    }
  }
}
