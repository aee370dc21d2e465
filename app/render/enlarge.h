/// app/render/enlarge.h: a picture drawn smaller, brought to its size. No OpenGL.
#pragma once

#include "app/engine/view.h"

namespace burrhole {

/// Linear between the middles of pixels, the outermost going on beyond them; rounded to nearest. The same bytes where the size is the same.
/// @param width, height at least 1; so is the image's own size.
[[nodiscard]] Image enlarge(const Image& image, int width, int height);

}  // namespace burrhole
