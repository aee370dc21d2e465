/// core/mesh/surface_offset.h: the way from the centre of a voxel to the 0.5 surface.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any.   Source  own derivation.
#pragma once

#include <optional>

#include "core/base/geometry.h"
#include "core/voxel/gradient.h"

namespace burrhole {

/// [voxel] An offset is not longer, and an offset depends on no voxel farther away than this, rounded up.
inline constexpr double kLongestOffset = 1.5;

/// @returns the density at a point [voxels], trilinear between the centres; outside of the block it is 0.
[[nodiscard]] double sample_density(const DensityBlock& block, const Vec3& p);

/// Follows the falling gradient of the density at the centre of a solid voxel, in a straight line, to the first place where the density,
/// trilinear between the centres, is 0.5. Density outside of the block is 0.
/// @returns the offset from the centre; none if the gradient is zero, as in the middle of a wall of one voxel, or the surface is farther
/// away than kLongestOffset. @pre voxel in block.box.
[[nodiscard]] std::optional<Vec3> offset_to_surface(const DensityBlock& block, const Vec3i& voxel);
/// The same along a given direction of any length; none if it is zero.
[[nodiscard]] std::optional<Vec3> offset_along(const DensityBlock& block, const Vec3i& voxel, const Vec3& direction);

}  // namespace burrhole
