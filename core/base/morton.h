/// core/base/morton.h: Morton (Z-order) code. Cells with nearby codes are close in space.
///   Frame  any integer grid.   Units  cells.
#pragma once

#include <cstdint>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kMortonCells = 1 << 21;  ///< cells along each axis

/// @returns the bits of three coordinates interleaved, x lowest. @pre each coordinate is in [0, kMortonCells).
[[nodiscard]] inline std::uint64_t morton_code(const Vec3i& cell) noexcept {
  std::uint64_t code = 0;
  for (std::uint64_t bit = 0; bit < 21; ++bit)
    for (std::size_t axis = 0; axis < 3; ++axis) code |= ((static_cast<std::uint64_t>(cell[axis]) >> bit) & 1u) << (3 * bit + axis);
  return code;
}

}  // namespace burrhole
