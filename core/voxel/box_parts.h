/// core/voxel/box_parts.h: sliding of dense windows: finds the new voxels and moves the values that are kept.
///   Arrays are dense over their box, i fastest.   Frame  index.   Errors  none.   Thread  any, on its own arrays.
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// @returns `box` without `hole`, as at most six disjoint boxes.
[[nodiscard]] std::vector<VoxelBox> box_without(const VoxelBox& box, const VoxelBox& hole);

/// @returns the part of `to` whose values remain valid when a window slides from `from` to `to`: the intersection, reduced by `margin`
/// [voxels] at each face that moved. Values within the margin depend on the position of the face.
[[nodiscard]] VoxelBox kept_by_slide(const VoxelBox& from, const VoxelBox& to, const Vec3i& margin);
[[nodiscard]] inline VoxelBox kept_by_slide(const VoxelBox& from, const VoxelBox& to, int margin) {
  return kept_by_slide(from, to, Vec3i(margin));
}

/// Moves the values in the intersection of both boxes from an array over `from` to an array over `to`; does not change other values. The
/// arrays may be the same, if it is long enough for both boxes.
///   In place, no row is overwritten before it is moved: rows that move to higher addresses are moved first, from last to first; then the
///   others, from first to last. Rows have the same order in both arrays, so the two groups do not overwrite each other.
template <class T>
void slide_values(const VoxelBox& from, const T* values, const VoxelBox& to, T* target) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  const VoxelBox both = from.intersect(to);
  if (both.empty()) return;
  const Vec3i size = both.size();
  const auto move_row = [&](int n, bool up) {
    const Vec3i start(both.lo.x, both.lo.y + n % size.y, both.lo.z + n / size.y);
    const std::size_t at = from.offset_of(start), goal = to.offset_of(start);
    if ((goal > at) == up) std::memmove(target + goal, values + at, static_cast<std::size_t>(size.x) * sizeof(T));
  };
  const int rows = size.y * size.z;
  for (int n = rows - 1; n >= 0; --n) move_row(n, true);
  for (int n = 0; n < rows; ++n) move_row(n, false);
}

/// The same for a vector, which is resized to `to`. Values outside of the intersection are undefined. Allocates only beyond the vector's
/// capacity.
template <class T>
void slide_array(const VoxelBox& from, const VoxelBox& to, std::vector<T>& values) {
  values.reserve(std::max(values.size(), to.count()));  // no more: resize() alone would double the capacity
  values.resize(std::max(values.size(), to.count()));
  slide_values(from, values.data(), to, values.data());
  values.resize(to.count());
}

/// Copies the values of `part` between dense arrays.
template <class T>
void copy_part(const VoxelBox& part, const VoxelBox& from_box, const T* from, const VoxelBox& to_box, T* to) noexcept {
  if (part.empty()) return;
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j) {
      const Vec3i start(part.lo.x, j, k);
      std::copy_n(from + from_box.offset_of(start), static_cast<std::size_t>(part.size().x), to + to_box.offset_of(start));
    }
}

/// Sets every voxel of `part` to `value`.
template <class T>
void fill_part(const VoxelBox& part, const T& value, const VoxelBox& box, T* values) noexcept {
  if (part.empty()) return;
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j)
      std::fill_n(values + box.offset_of({part.lo.x, j, k}), static_cast<std::size_t>(part.size().x), value);
}

}  // namespace burrhole
