/// tests/core/mesh/mesh_checks.h: what must hold of a mesh, from its half-edges alone; each check returns the first violation in words, or
/// nothing. Sabotage tests require that it returns one.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any.
#pragma once

#include <map>
#include <string>

#include "tests/core/mesh/pivot_twin.h"

namespace burrhole::test {

/// Between changes, also before resume(): each triangle is known once and is not degenerate; partners are the reverse of each other; front
/// edges are loops, have an empty ball and their third vertex; vertices have the state that follows from their edges.
[[nodiscard]] std::string front_error(const BallMesh& mesh, const MeshBone& bone);

/// After resume(): all that, and no open edge; core/tool's check of closed meshes finds nothing; an edge of more than two triangles is in
/// the list of shared edges and lies between parts of bone that touch there alone, or in a wall of one voxel; every surface voxel without a
/// triangle is an orphan with its reason.
[[nodiscard]] std::string mesh_error_of(const BallMesh& mesh, const MeshBone& bone);

/// Whether the mesh is the one of the slow twin: same triangles, edges, corners and parts.
[[nodiscard]] std::string twin_error(const BallMesh& mesh, const MeshBone& bone);

/// A triangle's corners with their offsets [voxels], in the order of the triangle.
using MovedTriangles = std::map<PlainTriangle, std::array<std::array<float, 3>, 3>>;
[[nodiscard]] MovedTriangles moved_triangles(const BallMesh& mesh);

}  // namespace burrhole::test
