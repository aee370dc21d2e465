/// tests/app/render/slow_ray_caster.h: the picture of a volume once more, one pixel after the other in double, sharing no code with
/// app/render.
#pragma once

#include "app/view/view.h"

namespace burrhole::test {

/// Deliberate faults, each of which the comparison must notice.
enum class Sabotage { none, flipped_normal, half_voxel_shift, light_from_elsewhere };

/// Bone and soft tissue with the light of the view (no finish, no tool); step [voxels] and bisections as the renderer is told.
[[nodiscard]] Image cast_slowly(const VolumeView& volume, const FrameView& view, int width, int height, double step, int bisections,
                                Sabotage sabotage = Sabotage::none);

}  // namespace burrhole::test
