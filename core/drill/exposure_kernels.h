/// core/drill/exposure_kernels.h: arguments of the SIMD kernels of exposure.cpp, equal for every level. Internal to exposure.cpp.
///   Frame  origin at the window's corner; lower corners of cells at integers.   Units  voxels.   Errors  none.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr double kFixedBias = 1572864.0;  ///< [-] 1.5 x 2^20: after adding it, a double has 32 bits of fraction, rounded to nearest
inline constexpr std::size_t kLongestRun = 1024;

struct StartArgs {
  const double *x, *y, *z, *span;                             // runs: start [m], points minus one
  std::size_t runs;                                           // padded to a multiple of 8
  Affine window_from_tool;                                    // lower corners of cells at integers
  Vec3 along;                                                 // [voxels] from point to point
  Vec3 least, most;                                           // [voxels] a run within these bounds is inside the box
  Vec3i strides, corner;                                      // of the field: offset of a voxel = dot(voxel - corner, strides)
  std::int32_t *base, *carry_x, *carry_y, *carry_z, *inside;  // [voxels] offset of the start of each run; flags
};

struct RunArgs {
  const std::uint32_t *first;  // of each run, plus the end of the last
  std::size_t runs;
  const std::int32_t *base, *carry_x, *carry_y, *carry_z, *inside;  // [voxels] offset of the start of each run; flags
  const std::int32_t *step_offset, *step_x, *step_y, *step_z;
  Vec3i strides;
  const std::uint64_t *before;  // null if every point has weight `weight`
  std::uint64_t weight;
  std::int64_t *sums;
};

}  // namespace burrhole
