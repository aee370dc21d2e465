/// app/view/skin.h: the skin of a head in pictures: a shell round the bone, with an opening round the entry.
///   Frame   bone frame.   Units  SI.   Errors  none.   Thread  uses all cores.
///   Source  own work. Contact never reads it.
#pragma once

#include "app/view/display_config.h"
#include "app/view/view.h"

namespace burrhole {

/// @returns the shell, without the triangles inside the opening, and the cut edge of the skin round it. @pre skin.body is set.
[[nodiscard]] SkinView make_skin(const SkinConfig& skin, const Pose& bone_from_approach);

}  // namespace burrhole
