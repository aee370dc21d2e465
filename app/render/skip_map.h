/// app/render/skip_map.h: distance of each voxel to the nearest voxel that may be solid, for empty space skipping.
///   Frame index, i fastest.  Units voxels, Chebyshev metric, at most kMaxSkip.   Errors  none.   Thread  one owner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kMaxSkip = 32;

/// A lower bound of the true distance, exact when made. It remains a lower bound when bone disappears; bone that grows lowers it.
class SkipMap {
 public:
  SkipMap() = default;
  /// @param solid 1 where a voxel reaches the drawn level, dims.x*dims.y*dims.z values.
  SkipMap(const Vec3i& dims, std::span<const std::uint8_t> solid);

  [[nodiscard]] std::span<const std::uint8_t> distances() const noexcept { return distance_; }
  /// Updates the map for voxels of `box` that are marked in `solid` (box.count() values) and are now solid.
  /// @returns the box whose distances changed; empty if none did.
  [[nodiscard]] VoxelBox raise(const VoxelBox& box, std::span<const std::uint8_t> solid);

 private:
  void sweep(int direction);

  VoxelBox all_;
  std::vector<std::uint8_t> distance_;
};

}  // namespace burrhole
