/// core/voxel/box_parts.h: what a dense window needs to slide: what is new, and moving what stays.
///   Arrays are dense over their box, i fastest.
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// `box` without `hole`, as at most six boxes that do not overlap.
[[nodiscard]] std::vector<VoxelBox> box_without(const VoxelBox& box, const VoxelBox& hole);

/// The part of `to` that keeps its values when a window slides from `from`: what both hold, `margin` voxels in from each face that moved
/// (what is computed near a face depends on where the face is), by axis.
[[nodiscard]] VoxelBox kept_by_slide(const VoxelBox& from, const VoxelBox& to, const Vec3i& margin);
[[nodiscard]] inline VoxelBox kept_by_slide(const VoxelBox& from, const VoxelBox& to, int margin) {
  return kept_by_slide(from, to, Vec3i(margin));
}

/// Moves the values that both boxes hold from an array over `from` to one over `to`; all others are left as they are. The arrays may be the
/// same if the boxes are of one size.
template <class T>
void slide_values(const VoxelBox& from, const T* values, const VoxelBox& to, T* target) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  const VoxelBox both = from.intersect(to);
  if (both.empty()) return;
  const Vec3i size = both.size();
  // Rows go in the order in which, in place, none is overwritten before it has moved.
  const bool upwards = from.offset_of(both.lo) >= to.offset_of(both.lo);
  for (int n = 0; n < size.z; ++n)
    for (int m = 0; m < size.y; ++m) {
      const Vec3i start(both.lo.x, upwards ? both.lo.y + m : both.hi.y - 1 - m, upwards ? both.lo.z + n : both.hi.z - 1 - n);
      std::memmove(target + to.offset_of(start), values + from.offset_of(start), static_cast<std::size_t>(size.x) * sizeof(T));
    }
}

/// The same for a whole vector, which takes the size of `to`; values that were in neither box are left unsaid.
template <class T>
void slide_array(const VoxelBox& from, const VoxelBox& to, std::vector<T>& values) {
  if (from.size() == to.size()) {
    slide_values(from, values.data(), to, values.data());
  } else {
    std::vector<T> other(to.count());
    slide_values(from, values.data(), to, other.data());
    values = std::move(other);
  }
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

/// Gives every voxel of `part` the same value.
template <class T>
void fill_part(const VoxelBox& part, const T& value, const VoxelBox& box, T* values) noexcept {
  if (part.empty()) return;
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j)
      std::fill_n(values + box.offset_of({part.lo.x, j, k}), static_cast<std::size_t>(part.size().x), value);
}

}  // namespace burrhole
