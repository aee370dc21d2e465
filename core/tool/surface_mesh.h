/// core/tool/surface_mesh.h: a triangle surface from a file, as given, and whether it encloses a solid.
///   Frame of the file.   Units as the caller scaled it, SI once in the program.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct SurfaceMesh {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise seen from outside
};

/// What keeps a surface from being the skin of a solid.
struct MeshCheck {
  std::size_t triangles = 0, degenerate = 0;
  std::size_t open_edges = 0;          ///< used by one triangle
  std::size_t holes = 0;               ///< closed chains of open edges
  double longest_hole = 0.0;           ///< [unit of positions] length of the longest such chain
  std::size_t non_manifold_edges = 0;  ///< used by more than two triangles
  std::size_t flipped_edges = 0;       ///< both triangles run along it the same way
  std::size_t parts = 0;               ///< connected components
  double volume = 0.0;                 ///< signed [unit^3]: negative when inside-out
};

/// Joins vertices at exactly the same place (STL repeats them) and drops those that no triangle uses; triangles keep their order.
/// @pre indices in range, positions finite.
[[nodiscard]] SurfaceMesh weld(const SurfaceMesh& mesh);
/// Vertices at exactly the same place are one. @pre indices are in range, positions finite; see mesh_fault.
[[nodiscard]] MeshCheck check_mesh(const SurfaceMesh& mesh);
/// One sentence with the numbers when the mesh is no closed, outward oriented solid; else nothing. Closed parts wound inward are cavities
/// and must lie inside another part. @pre positions in m: the sentence speaks of mm and cm3.
[[nodiscard]] std::optional<std::string> mesh_fault(const SurfaceMesh& mesh);

}  // namespace burrhole
