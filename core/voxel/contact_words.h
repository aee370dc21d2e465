/// core/voxel/contact_words.h: density, gradient and leap (size of the homogeneous neighbourhood) of a voxel in one 32-bit word.
///   Word      bits 0-7 density in 1/255. Bits 8-15, 16-23, 24-31 gradient i, j, k as int8 in 1/254 [density/voxel], -127..127. If the
///             gradient is zero (dead zone of the master window, or all three components below half a step), bits 24-31 are -128 and bits
///             8-15 are the leap.
///   Rounding  preserves both thresholds: only density 0 is 0; density >= 0.5 is >= 128, density < 0.5 is <= 127.
///   Leap      L >= 1: all voxels at a Chebyshev distance < L have zero gradient and the same side (empty, below 0.5, 0.5 and above), and
///             none is on the outermost layer of the window. A traversal that moves at most one voxel per step on each axis can take L
///             steps at once and sample only the end point; it does not leave the window.
///   Outermost layer of the window: empty, like everything outside.
///   Frame     index.   Errors  none.
///   Thread    simulation updates the words; contact reads copies.   Source  own derivation, shown in contact_words.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/voxel/voxmap.h"

namespace burrhole {

using ContactWord = std::uint32_t;

/// [voxels] largest leap. It limits the distance over which a change of density changes words.
inline constexpr int kMaxLeap = 8;
/// [voxels] a slide does not change words further than this from each face of the window that moved.
inline constexpr int kWordSlideMargin = kMaxLeap + 1;
inline constexpr std::uint32_t kWordSolid = 128;       ///< least density of a voxel on the solid side of the 0.5 level
inline constexpr float kWordLevel = 127.5f;            ///< the 0.5 level [1/255]
inline constexpr float kWordGradient = 254.0f;         ///< [steps/(density/voxel)]
inline constexpr ContactWord kEmptyWord = 0x80000100;  ///< density 0, no gradient, leap 1

class ContactWords {
 public:
  /// Computes all words: at the start, or after bone was restored.
  void rebuild(const MasterWindow& window);
  /// Updates the words after density or gradient changed inside `dirty`. @returns the box of words that may have changed. The result equals
  /// that of rebuild(), bit for bit.
  VoxelBox update(const MasterWindow& window, const VoxelBox& dirty);
  /// Updates the words after the window slid from box(): keeps the words of the intersection and computes the new ones. Changes of density
  /// inside the intersection require an additional update(). The result equals that of rebuild(), bit for bit.
  void slide(const MasterWindow& window);

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// Reserves memory for windows of up to `window_voxels`.
  void reserve(std::size_t window_voxels);
  /// Dense over box(), i fastest.
  [[nodiscard]] const std::vector<ContactWord>& words() const noexcept { return words_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  void place(const VoxelBox& box);
  void pack(const MasterWindow& window, const VoxelBox& target);
  void seed(const VoxelBox& target);
  void find_leaps(const VoxelBox& target);

  VoxelBox box_;
  std::vector<ContactWord> words_;
  std::vector<std::uint8_t> sides_, seeds_;  // padded: vector loads reach past both ends
  std::vector<std::uint8_t> across_;         // scratch of the distance
};

}  // namespace burrhole
