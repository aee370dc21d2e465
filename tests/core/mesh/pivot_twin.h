/// tests/core/mesh/pivot_twin.h: slow plain twin of the mesh, from the definition: all triangles of solid centres on which a ball rests that
/// has no solid centre inside. It shares no code with core/mesh: balls, angles and topology are computed in floating point from places.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "tests/core/mesh/mesh_cases.h"

namespace burrhole::test {

/// Three voxels, counter-clockwise from outside, as (z, y, x), the lowest first.
using PlainTriangle = std::array<std::array<int, 3>, 3>;
using PlainTriangles = std::set<PlainTriangle>;
[[nodiscard]] PlainTriangle plain_triangle(const Vec3i& a, const Vec3i& b, const Vec3i& c);

/// @returns every triangle with an empty ball; four centres on one ball are cut along the diagonal through the lowest one, by z, y, x.
[[nodiscard]] PlainTriangles twin_triangles(const MeshBone& bone, double radius = 0.933);

struct PlainTopology {
  std::size_t edges = 0, corners = 0, parts = 0, unpaired = 0;
};
/// Pairs the triangles at each edge by rolling the ball the shortest way, and counts. `corners`: fans of triangles at vertices.
[[nodiscard]] PlainTopology twin_topology(const PlainTriangles& triangles, double radius = 0.933);

/// @returns the triangles of a mesh.
[[nodiscard]] PlainTriangles triangles_of(const BallMesh& mesh);

}  // namespace burrhole::test
