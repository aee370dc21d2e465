/// core/voxel/gradient.h: density and its gradient by central differences. The paper derives normal and force direction from the gradient.
///   Frame   index axes.   Units  density [-], gradient [1/voxel].   Errors  none.   Thread  any, on its own arrays.
///   Source  [AcostaLiu07] sections 2-4 (gradients reused for force and shading). The dead zone is our own: without it, noise of a few
///           percent inside bone gives every interior voxel a gradient, and the traversal to the surface follows noise.
#pragma once

#include <span>

#include "core/base/geometry.h"

namespace burrhole {

/// Dense density over `box`, i fastest.
struct DensityBlock {
  VoxelBox box;
  std::span<const float> density;  ///< [-] 0..1
};

/// Arguments of the SIMD kernel of update_gradient. Strides in floats.
struct GradientRows {
  const float* density;  // [-] at the target's first voxel
  std::ptrdiff_t density_row, density_slab;
  float* gradient;  // [1/voxel] at the target's first voxel; x, y, z of a voxel are contiguous
  std::size_t gradient_row, gradient_slab;
  std::size_t count, rows, slabs;  // of the target
  float dead2;                     // [1/voxel^2] square of the dead zone
};

/// Arguments of the SIMD kernel of update_density.
struct ProductRows {
  const float *a, *b;  // [-] at the target's first voxel
  float* product;      // [-] likewise
  std::size_t row, slab;
  std::size_t count, rows, slabs;  // of the target
};

/// Sets density = occupancy x remaining for each voxel of `target`. All arrays are dense over `box`, i fastest. Requires target inside box.
void update_density(std::span<const float> occupancy, std::span<const float> remaining, const VoxelBox& box, const VoxelBox& target,
                    std::span<float> density) noexcept;

/// Writes the gradient of each voxel of `target` into `gradient` (dense over `gradient_box`, i fastest): half the difference of the two
/// neighbours on each axis [1/voxel]; (0,0,0) where its length is below `dead_zone`. Same bits at every SIMD level.
/// Requires target.grown(1) inside block.box and target inside gradient_box.
void update_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& gradient_box,
                     std::span<Vec3f> gradient) noexcept;

}  // namespace burrhole
