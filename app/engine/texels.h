/// app/engine/texels.h: voxels as the display wants them: normals and opacity in one RGBA8, colour beside it.
///   Source [AcostaLiu07] section 4, eq. 5. Colours are our own, from labels and hardness.
#pragma once

#include "app/engine/view.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Texels of a box as the bone is now; the box is cut to the volume. @returns an empty box when nothing of it lies inside.
[[nodiscard]] TexelBox make_texels(Voxmap& voxmap, const VoxelBox& box);

/// Normals, opacities and field of the whole volume before they are rounded.
[[nodiscard]] PreciseTexels make_precise_texels(Voxmap& voxmap);

/// The whole volume with colours. @param with_tissue also what each voxel was as loaded.
[[nodiscard]] VolumeView make_volume_view(Voxmap& voxmap, bool with_tissue = false);

}  // namespace burrhole
