/// app/view/detail.h: a large bone as two volumes: all of it at coarser voxels, and a part around the approach at its own voxels.
///   Frame  index of the bone, or of its coarse voxels where so named.   Units  voxels.   Errors  none.   Thread  any while the bone does not
///   change.
#pragma once

#include <cstddef>

#include "app/view/coarse_bone.h"
#include "app/view/display_config.h"
#include "app/view/view.h"

namespace burrhole {

/// @returns the edge of a coarse voxel [voxels] with which the whole bone has at most `most` texels; 1 if it has no more as it is.
[[nodiscard]] int coarse_factor(const Vec3i& dims, std::size_t most) noexcept;

/// @returns the edge of the detail on each axis.
[[nodiscard]] Vec3 detail_edge(const DisplayConfig& display, const Affine& bone_from_index) noexcept;

/// @param centre of the part. @param edge of the part. @returns the part, inside the bone. @pre factor is above 1.
[[nodiscard]] DetailGrid place_detail(const Vec3i& dims, int factor, const Vec3& centre, const Vec3& edge) noexcept;

/// @returns the voxels of the part whose texels may change with density and gradient in `box`; may be empty.
[[nodiscard]] VoxelBox detail_of(const DetailGrid& grid, const VoxelBox& box) noexcept;
/// @returns whether a voxel of the box is near a face of the part. @pre box lies inside the part.
[[nodiscard]] bool is_blended(const DetailGrid& grid, const VoxelBox& box) noexcept;
/// @returns the coarse voxels that surround a box, at least two on each axis. @pre box lies inside the part.
[[nodiscard]] VoxelBox coarse_around(const DetailGrid& grid, const VoxelBox& box, const Vec3i& coarse_dims) noexcept;

/// Changes the texels of voxels near the faces of the part to those of the coarse volume. @param coarse texels of a box that contains
/// coarse_around(own.box). @param own box in voxels of the bone.
void blend_with_coarse(const DetailGrid& grid, const TexelBox& coarse, TexelBox& own);

/// @returns the part as a volume. Uses all cores.
[[nodiscard]] DetailView make_detail_view(const DetailGrid& grid, const CoarseBone& coarse, const Voxmap& voxmap, bool with_tissue);

}  // namespace burrhole
