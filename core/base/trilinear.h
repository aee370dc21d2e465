/// core/base/trilinear.h: trilinear interpolation between the eight corners of a cell.
///   Frame  that of the grid.
///   Order  linear along x, then y, then z, each a + (b - a) t. Recorded forces and hashes depend on this order and form.
///   SIMD   core/base/trilinear-inl.h is the same for vectors, with the same bits in single precision.
#pragma once

#include <cstddef>

#include "core/base/geometry.h"

namespace burrhole {

/// Where corner n lies in a dense array, i fastest, from corner 0 on. @param step between neighbours along x
template <class Offset>
[[nodiscard]] constexpr Offset corner_offset(unsigned n, Offset row, Offset slab, Offset step = 1) noexcept {
  return ((n & 1u) != 0 ? step : 0) + ((n & 2u) != 0 ? row : 0) + ((n & 4u) != 0 ? slab : 0);
}

/// @param t place in the cell, 0..1 on each axis   @param corner corner(n) is the value of corner n, counted as in core/base/bounds.h
template <class Real, class Corner>
[[nodiscard, gnu::always_inline]] inline auto trilinear(const glm::vec<3, Real>& t, const Corner& corner) noexcept {
  using Value = decltype(corner(0u));
  const auto mix = [](const Value& a, const Value& b, Real share) { return a + (b - a) * share; };
  const auto along_x = [&](unsigned n) { return mix(corner(n), corner(n + 1), t.x); };
  return mix(mix(along_x(0), along_x(2), t.y), mix(along_x(4), along_x(6), t.y), t.z);
}

/// The same in a dense array over `box`, i fastest. @param index index coordinates; the cell's eight voxels must lie in the box.
[[nodiscard]] inline double trilinear(const VoxelBox& box, const float* values, const Vec3& index) noexcept {
  const Vec3i base = floor_int(index);
  const Vec3i size = box.size();
  const float* first = values + box.offset_of(base);
  const std::ptrdiff_t row = size.x, slab = row * size.y;
  return trilinear(index - Vec3(base), [&](unsigned n) { return static_cast<double>(first[corner_offset(n, row, slab)]); });
}

}  // namespace burrhole
