/// app/view/texels.h: makes the texels of voxels: normals and opacity in one RGBA8, colours in another.
///   Frame  index of the bone.   Units  texels.   Errors  none.   Thread  one, the owner of the bone.
///   Source [AcostaLiu07] section 4, eq. 5. Colours are our own, from labels and hardness.
#pragma once

#include <span>

#include "app/view/added_mesh.h"
#include "app/view/drawn_bone.h"
#include "app/view/view.h"

namespace burrhole {

/// Density from which the texels of a box are made. The owner of the bone reads it; another thread can make the texels from it.
struct TexelSource {
  VoxelBox box;                ///< inside the volume
  std::vector<float> density;  ///< [-] over box.grown(1)
};

/// Reads the present density of a box, clipped to the volume, into `out`, whose memory is reused. Does not access OpenVDB if the window
/// contains box.grown(1).
void read_texel_source(const DrawnBone& bone, const VoxelBox& box, TexelSource& out);
/// @returns the texels of `source`. Soft tissue is read from `loaded`, which is constant. @param dead_zone [density/voxel] shorter gradients
/// are zero. @param tops where effects have moved the upper face of soft tissue.
[[nodiscard]] TexelBox make_texels(const BoneModel& loaded, float dead_zone, const TexelSource& source,
                                   std::span<const SoftTop* const> tops = {});

/// @returns the present texels of a box, clipped to the volume; empty if the box is outside the volume.
[[nodiscard]] TexelBox make_texels(const Voxmap& voxmap, const VoxelBox& box);

/// @returns normals, opacities and field of the whole volume before rounding.
[[nodiscard]] PreciseTexels make_precise_texels(const Voxmap& voxmap);

/// @returns a part of the bone with colours, as a volume of its own. Uses all cores. @param with_tissue also the state of each voxel as
/// loaded. @pre part lies inside the bone.
[[nodiscard]] VolumeView make_volume_view(const DrawnBone& bone, const VoxelBox& part, bool with_tissue);
/// @returns the whole bone at its own voxels.
[[nodiscard]] VolumeView make_volume_view(const Voxmap& voxmap, bool with_tissue = false);

}  // namespace burrhole
