/// volumes/read/quiet_values.h: voxels of a scan round which values are so low and flat that there is no bone between them.
///   Frame  index of the values.   Units  that of the values; voxels.   Errors none.   Thread any.
///   Bound  M and L are the largest and the smallest value within `reach` voxels, R = M - L. An interpolated value (resample.h) exceeds M by at
///          most 0.1875 R, and the steps to the next voxels of the grid, one on each axis, add up to at most `steps` R. Occupancy
///          (bone_from_scan.h) is 0 where M + 0.1875 R + max(half_band, steps R) <= middle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

struct QuietRule {
  double middle = 0.0, half_band = 0.0;  ///< [HU or the unit of the values] of the band of bone
  double nothing = 0.0;                  ///< [HU or the unit of the values] of the places outside the scan
  double steps = 4.125;                  ///< [-]
};

class QuietValues {
 public:
  /// @param reach [voxels] on each axis.
  QuietValues(std::span<const float> values, const Vec3i& dims, const Vec3i& reach, const QuietRule& rule);

  /// @returns the bytes that the constructor takes at most.
  [[nodiscard]] static std::uint64_t bytes(const Vec3i& dims) noexcept;
  [[nodiscard]] bool at(const Vec3i& voxel) const noexcept { return quiet_[blocks_.offset_of(voxel / kEdge)] != 0; }

 private:
  static constexpr int kEdge = 3;  // voxels are classified in blocks of this edge
  VoxelBox blocks_;
  std::vector<std::uint8_t> quiet_;
};

}  // namespace burrhole
