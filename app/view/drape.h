/// app/view/drape.h: a surgical drape in pictures: a cloth over the body around the bone, with a window round the entry.
///   Frame   approach frame: +z is up, so the cloth hangs towards -z.   Units  SI.   Errors  none.   Thread  uses all cores.
///   Source  own work. The cloth is bone to the shaders, in texels of the coarse volume alone; contact never reads it.
#pragma once

#include "app/view/display_config.h"
#include "app/view/view.h"

namespace burrhole {

/// [-] Colour of cloth: the only one in which green exceeds red, by which the shader knows it.
inline constexpr Vec3 kClothColor{0.36, 0.62, 0.60};

/// Adds the cloth to the texels of the coarse volume. @param region [voxels of the bone] in which there is none. @param factor [voxels of the
/// bone] edge of a coarse voxel. @param bottom [m] height of the table, where the cloth
/// ends. @pre drape.body is set.
void add_drape(const DrapeConfig& drape, const Pose& bone_from_approach, const VoxelBox& region, int factor, double bottom,
               VolumeView& whole);

}  // namespace burrhole
