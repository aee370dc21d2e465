/// app/render/skip_map.h: how far each voxel is from the nearest one that may be solid, for skipping empty space.
///   Frame index, i fastest.  Units voxels, Chebyshev metric, at most kMaxSkip.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kMaxSkip = 32;

/// A lower bound on the true distance, exact when made. Bone that disappears leaves it safe as it is; bone that grows lowers it.
class SkipMap {
 public:
  SkipMap() = default;
  /// @param solid 1 where a voxel reaches the drawn level, dims.x*dims.y*dims.z values.
  SkipMap(const Vec3i& dims, std::span<const std::uint8_t> solid);

  [[nodiscard]] std::span<const std::uint8_t> distances() const noexcept { return distance_; }
  /// Tells the map that voxels of `box` marked in `solid` (box.count() values) are solid now.
  /// @returns the box whose distances changed, empty when the map knew them all.
  [[nodiscard]] VoxelBox raise(const VoxelBox& box, std::span<const std::uint8_t> solid);

 private:
  void sweep(int direction);

  VoxelBox all_;
  std::vector<std::uint8_t> distance_;
};

}  // namespace burrhole
