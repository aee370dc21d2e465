/// volumes/write/bone_surface.h: the 0.5 surface of a bone as a closed triangle mesh, by OpenVDB's volumeToMesh (dual contouring).
///   Frame  bone frame (LPS).   Units  m.   Errors  bad_input: no surface, more vertices than 32 bits count.   Thread  one; uses all cores.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

/// What is meshed.
struct DensitySource {
  std::vector<VoxelBox> regions;  ///< boxes that together hold all voxels with a density above 0, in any order
  Affine bone_from_index;         ///< [m]
  /// Reads the density [-] of a box, i fastest; 0 outside the bone.
  std::function<void(const VoxelBox& box, std::span<float> out)> read;
};

/// @returns the surface, counter-clockwise seen from outside. Its vertices lie at the mean of the crossings of the cell's edges.
[[nodiscard]] Result<SurfaceMesh> make_bone_surface(const DensitySource& density);

}  // namespace burrhole
