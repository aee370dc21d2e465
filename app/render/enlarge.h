/// app/render/enlarge.h: resamples a picture to a larger or smaller size. No OpenGL.
///   Units  pixels.   Errors  none.
#pragma once

#include "app/view/view.h"

namespace burrhole {

/// Linear interpolation between pixel centres, constant beyond the outermost; rounded to nearest. An equal size returns the same bytes.
/// @param width, height >= 1; so is the size of the image.
[[nodiscard]] Image enlarge(Image image, int width, int height);
/// Means of blocks of n x n pixels, rounded to nearest. @pre sides are multiples of n.
[[nodiscard]] Image shrink(const Image& large, int n);

}  // namespace burrhole
