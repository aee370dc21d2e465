/// volumes/read/mesh_to_occupancy.h: converts a closed surface to occupancy on a grid.
///   Frame   of the mesh.   Units SI.   Errors  unavailable.   Source  own derivation.
///   Value   the ramp of volumes/phantom/phantom.h: 0.5 - d / (2 w) clamped to 0..1, d the signed distance to the surface, w = pitch *
///           (|nx| + |ny| + |nz|), n the direction to the nearest point of the surface. Trilinear interpolation places the 0.5 level of a
///           plane of any tilt exactly on the plane; edges deviate by a fraction of a voxel. A voxel outside is always below 0.5, a voxel
///           inside never.
///   Sign    winding number > 0 (core/tool/mesh_slices.h): overlapping parts are one solid, without the walls inside it; parts with inward
///           orientation are cavities. OpenVDB's meshToVolume is not used: it treats only the region connected to the outside as outside,
///           so it fills every closed cavity (measured with 10.0: two nested boxes become solid).
#pragma once

#include <functional>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// [voxels] Layers without bone around the mesh.
inline constexpr int kMeshMargin = 3;
/// [voxels] Largest grid of a mesh: 4 GB of values.
inline constexpr double kMaxMeshVoxels = 1e9;

/// @returns the voxels along each axis for a box of `size` [m], as doubles, so that an extreme pitch cannot overflow.
[[nodiscard]] Vec3 mesh_grid_dims(const Vec3& size, double pitch) noexcept;

/// @param pitch [m] > 0. @param advance receives the share done, and its error ends the work; may be empty.
/// @pre mesh_error(mesh) finds none; the grid has at most kMaxMeshVoxels.
/// @returns Quantity::occupancy; ErrorCode::unavailable if the memory cannot be allocated. 4 bytes per voxel, plus some slices.
[[nodiscard]] Result<Scan> mesh_to_occupancy(const SurfaceMesh& mesh, double pitch, const std::function<Status(double)>& advance);

}  // namespace burrhole
