/// app/render/tip_slices_picture.h: draws three slices through the tip side by side into one picture. No OpenGL.
///   Units  pixels.   Errors  none.   Thread  any.
#pragma once

#include "app/view/tip_slices.h"
#include "app/view/view.h"

namespace burrhole {

[[nodiscard]] Image draw_tip_slices(const TipSlices& slices);

}  // namespace burrhole
