/// core/mesh/mesh_census.h: what a mesh by ball pivoting consists of: parts, holes through them, edges used twice, voxels left out.
///   Topology   Counted along partners. At a vertex that is used more than once, each closed fan of triangles counts as a corner of its own. So
///     every closed part has an even Euler number, corners - edges + triangles = 2 - 2 genus, also where parts of bone touch.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  that of the mesh.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/ball_mesh.h"

namespace burrhole {

struct MeshCensus {
  std::size_t triangles = 0;
  std::size_t vertices = 0;                        ///< voxels
  std::size_t corners = 0;                         ///< fans of triangles, closed or ending at open edges
  std::size_t edges = 0;                           ///< pairs of partners, and open half-edges
  std::size_t open_edges = 0;                      ///< half-edges without a partner: front and border
  std::size_t parts = 0;                           ///< connected along partners; a closed cavity is one
  double volume = 0.0;                             ///< [voxel^3] that the triangles enclose, at the positions of the vertices
  std::vector<std::array<Vec3i, 2>> shared_edges;  ///< [voxels] lower end first: edges of more than two triangles

  /// @returns the number of handles of all parts together. @pre no open edges.
  [[nodiscard]] std::size_t genus() const noexcept { return parts - (corners + triangles - edges) / 2; }
};
[[nodiscard]] MeshCensus take_census(const BallMesh& mesh);

/// A surface voxel that is no vertex of a triangle: no ball rests on it, because every cell in which one of its faces is free has at most
/// two solid corners.
struct OrphanVoxel {
  Vec3i voxel{0};           ///< [voxels]
  unsigned neighbours = 0;  ///< solid ones of 26: none, the voxel is alone; otherwise it belongs to a chain one voxel thick
};
/// @returns the orphans in the order of index. Reads the whole box.
[[nodiscard]] std::vector<OrphanVoxel> find_orphans(const BallMesh& mesh);

}  // namespace burrhole
