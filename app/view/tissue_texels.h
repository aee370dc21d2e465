/// app/view/tissue_texels.h: texels that do not change while drilling: colours, and the state of each voxel as loaded.
///   Frame  index of the bone.   Units  texels, i fastest.   Errors  none.   Thread  any; the bone is constant.
///   Source colours and patterns are our own, from labels and hardness.
#pragma once

#include <algorithm>
#include <vector>

#include "app/view/view.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

/// @returns 0..255 of a fraction, rounded.
[[nodiscard]] inline std::uint8_t to_byte(double fraction) noexcept {
  return static_cast<std::uint8_t>(std::clamp(fraction * 255.0 + 0.5, 0.0, 255.0));
}

/// @returns colours by tissue; alpha is the occupancy of soft tissue. The same for any partition of the bone. @pre box is inside the bone.
[[nodiscard]] std::vector<Rgba8> make_colors(const BoneModel& bone, const VoxelBox& box);
/// @returns occupancy as loaded, and sponginess from the mineral density, within bounds for tables and diploe that are labelled.
/// @pre box is inside the bone.
[[nodiscard]] std::vector<TissueTexel> make_tissue(const BoneModel& bone, const VoxelBox& box);

}  // namespace burrhole
