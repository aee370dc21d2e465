/// core/tool/surface_mesh.h: a triangle mesh from a file, and the check that it encloses a solid.
///   Frame  of the file.   Units  any unit of length, the same for all members. Files are scaled to m on loading; mesh_error() requires m.
///   Errors  mesh_error() returns one sentence.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct SurfaceMesh {
  std::vector<Vec3> positions;         ///< [unit of the caller] vertices
  std::vector<std::uint32_t> indices;  ///< three per triangle, counter-clockwise seen from outside
};

/// Properties that prevent a mesh from being the surface of a solid.
struct MeshCheck {
  std::size_t triangles = 0;           ///< all, degenerate ones included
  std::size_t degenerate = 0;          ///< triangles with fewer than three distinct vertices; the following members ignore them
  std::size_t open_edges = 0;          ///< edges of one triangle only
  std::size_t holes = 0;               ///< chains of connected open edges, also those that do not close
  double longest_hole = 0.0;           ///< [unit of positions] length of the longest such chain
  std::size_t non_manifold_edges = 0;  ///< edges of more than two triangles
  std::size_t flipped_edges = 0;       ///< edges that both triangles traverse in the same direction
  std::size_t parts = 0;               ///< connected components
  double volume = 0.0;                 ///< [unit of positions^3] signed: negative if inside-out
};

/// Merges vertices at equal positions (STL repeats them) and removes unused vertices; triangles keep their order.
/// @pre indices in range, positions finite.
[[nodiscard]] SurfaceMesh weld(const SurfaceMesh& mesh);
/// Checks a mesh. Vertices at equal positions count as one. @pre indices in range, positions finite; see mesh_error.
[[nodiscard]] MeshCheck check_mesh(const SurfaceMesh& mesh);
/// @returns one sentence with the numbers if the mesh is not a closed, outward oriented solid; nothing otherwise. Closed parts with inward
/// orientation are cavities and must lie inside another part. @pre positions in m: the sentence uses mm and cm3.
[[nodiscard]] std::optional<std::string> mesh_error(const SurfaceMesh& mesh);

}  // namespace burrhole
