/// core/tool/mesh_slices.h: determines which points of a lattice lie inside a closed mesh.
///   Frame   that of the mesh.   Units  those of the mesh.   Errors  none.   Source  own derivation, shown in mesh_slices.cpp.
///   Inside  winding number > 0: overlapping parts are one solid; a part with inward orientation inside another is a cavity.
///   Ties    every edge is evaluated from its own two ends by half-open rules, so both of its triangles agree bit for bit, and each row
///           enters the mesh as often as it leaves it, independent of rounding. A lattice point on the surface belongs to the solid on its
///           right (+x). Degenerate triangles need no special case.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

/// Points origin + pitch * (i, j, k), 0 <= (i, j, k) < dims.
struct PointLattice {
  Vec3 origin{0.0};    ///< [unit of the mesh]
  double pitch = 0.0;  ///< [unit of the mesh] > 0
  Vec3i dims{0};       ///< [points] per axis
};

/// Calls use(k, inside) for k = 0 .. dims.z - 1 until it returns false. `inside` holds dims.x*dims.y bytes, i fastest, 1 inside the solid.
/// Time is proportional to the number of (triangle, slice) and (triangle, row) crossings, memory to the size of a slice.
/// @pre mesh_error(mesh) returns nothing.
void for_each_slice(const SurfaceMesh& mesh, const PointLattice& lattice,
                    const std::function<bool(int, std::span<const std::uint8_t>)>& use);

/// @returns for each point the number of entries minus exits of the ray from x = -infinity to the point, excluding a crossing at the point.
[[nodiscard]] std::vector<int> windings_left_of(const SurfaceMesh& mesh, std::span<const Vec3> points);

}  // namespace burrhole
