/// core/tool/mesh_slices.h: which points of a lattice a closed mesh holds.
///   Inside  winding number above 0: overlapping parts are one solid, a part wound inward inside another is a cavity.
///   Ties    every edge is judged from its own two ends by half-open rules, so both of its triangles agree bit for bit and each row leaves
///           the mesh as often as it enters: no leaks, whatever the rounding. A lattice point on the surface belongs to the solid on its
///           right (+x). Degenerate triangles need no care.
///   Frame and units  those of the mesh.   Source  own derivation, shown in mesh_slices.cpp.
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
  Vec3 origin{0.0};
  double pitch = 0.0;  ///< > 0
  Vec3i dims{0};
};

/// Calls use(k, inside) for k = 0 .. dims.z - 1 until it returns false. `inside` holds dims.x*dims.y bytes, i fastest, 1 within the solid.
/// @pre mesh_fault(mesh) finds no fault. Time goes with the number of (triangle, slice) and (triangle, row) meetings; memory with a slice.
void for_each_slice(const SurfaceMesh& mesh, const PointLattice& lattice,
                    const std::function<bool(int, std::span<const std::uint8_t>)>& use);

/// For each point, entries less exits of the ray from x = -infinity to it, what is met at the point itself not counted.
[[nodiscard]] std::vector<int> windings_left_of(const SurfaceMesh& mesh, std::span<const Vec3> points);

}  // namespace burrhole
