/// app/view/picture_memory.h: predicted memory of drawing a picture.   Units  bytes.   Thread  any: no state.
#pragma once

#include <cstdint>

#include "app/view/display_config.h"

namespace burrhole {

/// @returns what the pixels of one picture take while it is drawn, with the rays of its quality: colour, depth, stencil and hit of the bone,
/// colour and depth with the tool, and the picture that is read back. Measured with a driver that draws in memory, at 512 to 4096 pixels an
/// edge and four rays a pixel: 29 bytes a ray, and 41 for slices. Memory of a graphics card is counted as memory too.
[[nodiscard]] std::uint64_t picture_bytes(const DisplayConfig& display) noexcept;

}  // namespace burrhole
