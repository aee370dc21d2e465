/// core/voxel/window_size.h: the sizes that a window of dense voxels may have.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any.
#pragma once

#include <cstddef>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kLeastWindowEdge = 5;  ///< a voxel that may be eroded, with two layers on each side
inline constexpr int kMaxWindowEdge = 512;  ///< a long tool in fine voxels
/// 0.27 GB of the arrays of MasterWindow.
inline constexpr std::size_t kMaxWindowVoxels = std::size_t{1} << 24;

/// @returns whether a window may have that size.
[[nodiscard]] constexpr bool fits_window(const Vec3i& size) noexcept {
  for (const int edge : {size.x, size.y, size.z})
    if (edge < kLeastWindowEdge || edge > kMaxWindowEdge) return false;
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z) <= kMaxWindowVoxels;
}

}  // namespace burrhole
