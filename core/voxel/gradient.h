/// core/voxel/gradient.h: density gradient by central differences, index axes, per voxel; the paper's normal and force direction.
///   Source  [AcostaLiu07] sections 2-4 (gradients reused for force and shading); the dead zone is our own: noise of a few percent inside
///           bone otherwise gives every interior voxel a direction and the surface walk wanders.
#pragma once

#include <span>

#include "core/base/geometry.h"

namespace burrhole {

/// Dense density over `box`, i fastest.
struct DensityBlock {
  VoxelBox box;
  std::span<const float> density;
};

/// Writes the gradient of each voxel of `target` into `gradient` (dense over `gradient_box`, i fastest): half the difference of the two
/// neighbours on each axis [1/voxel]; (0,0,0) where its length is below `dead_zone`.
/// Requires target.grown(1) inside block.box and target inside gradient_box.
void update_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& gradient_box,
                     std::span<Vec3f> gradient) noexcept;

}  // namespace burrhole
