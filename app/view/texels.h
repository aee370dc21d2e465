/// app/view/texels.h: makes the texels of voxels: normals and opacity in one RGBA8, colours in another.
///   Frame  index of the bone.   Units  texels.   Errors  none.   Thread  one, the owner of the bone.
///   Source [AcostaLiu07] section 4, eq. 5. Colours are our own, from labels and hardness.
#pragma once

#include "app/view/view.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Density from which the texels of a box are made. The owner of the bone reads it; another thread can make the texels from it.
struct TexelSource {
  VoxelBox box;                ///< inside the volume
  std::vector<float> density;  ///< [-] over box.grown(1)
};

/// Reads the present density of a box, clipped to the volume, into `out`, whose memory is reused. Does not access OpenVDB if the window
/// contains box.grown(1).
void read_texel_source(const Voxmap& voxmap, const VoxelBox& box, TexelSource& out);
/// @returns the texels of `source`. Soft tissue is read from `bone`, which is constant. @param dead_zone [density/voxel] shorter gradients
/// are zero.
[[nodiscard]] TexelBox make_texels(const BoneModel& bone, float dead_zone, const TexelSource& source);

/// @returns the present texels of a box, clipped to the volume; empty if the box is outside the volume.
[[nodiscard]] TexelBox make_texels(const Voxmap& voxmap, const VoxelBox& box);

/// @returns normals, opacities and field of the whole volume before rounding.
[[nodiscard]] PreciseTexels make_precise_texels(const Voxmap& voxmap);

/// @returns the whole volume with colours. @param with_tissue also the state of each voxel as loaded.
[[nodiscard]] VolumeView make_volume_view(const Voxmap& voxmap, bool with_tissue = false);

}  // namespace burrhole
