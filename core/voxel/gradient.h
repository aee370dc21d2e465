/// core/voxel/gradient.h: density and its gradient by central differences. [AcostaLiu07] derives normal and force direction from the
/// gradient.
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

/// Arguments of the SIMD kernel of update_gradient.
struct GradientRows {
  const float* density;                      // [-] at the target's first voxel
  std::ptrdiff_t density_row, density_slab;  // [floats] from a voxel to its neighbour along j, along k
  float* gradient;                           // [1/voxel] at the target's first voxel; x, y, z of a voxel are contiguous
  std::size_t gradient_row, gradient_slab;   // [floats] likewise
  std::size_t count, rows, slabs;            // [voxels] of the target along i, j, k
  float dead2;                               // [1/voxel^2] square of the dead zone
};

/// Arguments of the SIMD kernel of update_density. The three arrays have the same strides.
struct ProductRows {
  const float *a, *b;              // [-] at the target's first voxel
  float* product;                  // [-] at the target's first voxel: a x b
  std::size_t row, slab;           // [floats] from a voxel to its neighbour along j, along k
  std::size_t count, rows, slabs;  // [voxels] of the target along i, j, k
};

/// Sets density = occupancy x remaining for each voxel of `target`. All arrays are dense over `box`, i fastest. Requires target inside box.
void update_density(std::span<const float> occupancy, std::span<const float> remaining, const VoxelBox& box, const VoxelBox& target,
                    std::span<float> density) noexcept;

/// Writes the gradient [1/voxel] of each voxel of `target` into `gradient` (dense over `gradient_box`, i fastest): on each axis, half the
/// difference between the densities of the next and the previous voxel. It is (0, 0, 0) where its length is below `dead_zone` [1/voxel].
/// Same bits at every SIMD level. Requires target.grown(1) inside block.box and target inside gradient_box.
void update_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& gradient_box,
                     std::span<Vec3f> gradient) noexcept;

}  // namespace burrhole
