/// app/view/drawn_bone.h: bone as a picture shows it, at its own voxels or at coarser ones (coarse_bone.h).
///   Frame  index of `loaded`.   Units  [-].   Errors  none.   Thread  any while the bone does not change.
#pragma once

#include <functional>
#include <span>

#include "core/voxel/voxmap.h"

namespace burrhole {

struct DrawnBone {
  const BoneModel* loaded = nullptr;  ///< bone as loaded
  /// Reads the present density of a box, i fastest; the box may reach outside the bone, where the density is 0.
  std::function<void(const VoxelBox& box, std::span<float> out)> read_density;
  float dead_zone = 0.0f;  ///< [1/voxel] shorter gradients of the density are zero
};

/// @returns the bone at its own voxels. @pre `voxmap` outlives the result.
[[nodiscard]] inline DrawnBone drawn_bone(const Voxmap& voxmap) {
  return {&voxmap.bone(), [&voxmap](const VoxelBox& box, std::span<float> out) { voxmap.read_density(box, out); },
          voxmap.config().gradient_dead_zone};
}

}  // namespace burrhole
