/// core/base/morton.h: Morton (Z-order) code. The codes from k 8^n to (k + 1) 8^n - 1 are those of one aligned cube of 2^n cells per side,
/// so cells sorted by code are grouped in cubes. Cells of consecutive codes may be far apart: the curve jumps where a cube ends.
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
