/// core/voxel/coarse_distance.h: a lower bound of the distance from a point to bone as loaded, for the whole bone at one number per block of
///   8^3 voxels. Drilling only removes bone, so the bound holds for the whole run. Contact and the window use it where the window is not.
///   Frame   index for points.   Units  m.   Errors none.   Thread  any; constant after creation.
///   Bound   A block holds bone if one of its voxels has an occupancy above 0. Trilinear samples are above 0 up to one voxel beyond such a
///           voxel. Two blocks that differ by d blocks on an axis are at least 8 (|d| - 1) voxels apart on it. So a point of the one is at
///           least 8 |max(|d| - 1, 0)| - sqrt(3) voxels from bone in the other.
///   Source  distance transform: Felzenszwalb & Huttenlocher 2012.
#pragma once

#include <vector>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

class CoarseDistance {
 public:
  explicit CoarseDistance(const BoneModel& bone);

  /// @returns a lower bound [m] >= 0 of the distance from a point in index coordinates to bone; infinity where there is no bone at all.
  [[nodiscard]] double at(const Vec3& index) const noexcept BH_REALTIME;
  [[nodiscard]] std::size_t bytes() const noexcept { return gap_.size() * sizeof(float); }
  /// @returns the bytes for a grid of that size: an upper bound.
  [[nodiscard]] static std::size_t bytes_for(const Vec3i& dims) noexcept;

 private:
  VoxelBox blocks_;         // [blocks] round all that hold bone
  std::vector<float> gap_;  // [voxels] bound per block, i fastest
  double scale_ = 0.0;      // [m] least length of an index vector of length 1
};

}  // namespace burrhole
