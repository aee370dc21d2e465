/// core/drill/exposure_kernels.h: what exposure.cpp hands to its SIMD kernels, one form for every level. Not for others.
///   Frame  the window's corner is the origin [voxels], cells' lower corners at whole numbers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr double kFixedBias = 1572864.0;  ///< 1.5 x 2^20: added, a double keeps 32 bits of fraction, rounded to nearest
inline constexpr std::size_t kLongestRun = 1024;

struct StartArgs {
  const double *x, *y, *z, *span;  // runs: start [m], points less one
  std::size_t runs;                // padded to a multiple of 8
  Affine window_from_tool;         // cells' lower corners at whole numbers
  Vec3 along;                      // [voxels] from point to point
  Vec3 least, most;                // runs within are inside for certain
  Vec3i strides, corner;           // of the field: offset of a voxel = dot(voxel - corner, strides)
  std::int32_t *base, *carry_x, *carry_y, *carry_z, *inside;
};

struct RunArgs {
  const std::uint32_t *first;  // of each run, and the end of the last
  std::size_t runs;
  const std::int32_t *base, *carry_x, *carry_y, *carry_z, *inside;
  const std::int32_t *step_offset, *step_x, *step_y, *step_z;
  Vec3i strides;
  const std::uint64_t *before;  // null where every point weighs `weight`
  std::uint64_t weight;
  std::int64_t *sums;
};

}  // namespace burrhole
