/// volumes/read/mesh_to_occupancy.h: a closed surface to occupancy on a grid.
///   Value   the ramp of volumes/phantom/phantom.h: 0.5 - d / (2 w) clamped to 0..1, d the signed distance to the surface, w = pitch *
///           (|nx| + |ny| + |nz|), n the direction to the nearest point of it. Trilinear interpolation puts the 0.5 level of a plane of any
///           tilt exactly on it; edges are off by a fraction of a voxel. A voxel outside is always below 0.5, one inside never.
///   Sign    winding number above 0 (core/tool/mesh_slices.h): overlapping parts are one solid and the walls within it are not seen; parts
///           wound inward are cavities. OpenVDB's meshToVolume is not used: it calls outside only what can be reached from outside, and so
///           fills every closed cavity (measured with 10.0: two nested boxes come out solid).
///   Frame   of the mesh.   Units SI.   Source  own derivation.
#pragma once

#include <functional>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// Layers of voxels without bone round the mesh.
inline constexpr int kMeshMargin = 3;
/// Most voxels a mesh is sampled to: 4 GB of values.
inline constexpr double kMaxMeshVoxels = 1e9;

/// Voxels along each axis that a box of `size` [m] takes, as doubles: absurd pitches cannot overflow.
[[nodiscard]] Vec3 mesh_grid_dims(const Vec3& size, double pitch) noexcept;

/// @param pitch [m] > 0. @param progress share done, may be empty. @pre mesh_fault(mesh) finds none and the grid is within kMaxMeshVoxels.
/// @returns Quantity::occupancy; ErrorCode::unavailable when the memory cannot be had. 4 bytes a voxel beside some slices.
[[nodiscard]] Result<Scan> mesh_to_occupancy(const SurfaceMesh& mesh, double pitch, const std::function<void(double)>& progress);

}  // namespace burrhole
