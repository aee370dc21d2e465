/// core/voxel/contact_words.h: what contact asks of a voxel in one 32-bit word: density, gradient, and how far nothing changes.
///   Word      bits 0-7 density in 1/255. Bits 8-15, 16-23, 24-31 gradient i, j, k as int8 in 1/254 [density/voxel], -127..127; or, where
///             the gradient is zero (the dead zone of the master window, or all three parts below half a step), bits 24-31 are -128 and
///             bits 8-15 a leap.
///   Rounding  keeps both rules of what is solid: density 0 and only 0 is 0; 0.5 and above is 128 and above, below 0.5 is 127 and below.
///   Leap      L >= 1: every voxel nearer than L (Chebyshev distance) has no gradient and is on the same side (empty, below 0.5, 0.5 and
///             above), and none of them is on the window's outermost layer. A walk of at most one voxel a step on each axis may take L
///             steps at once and look only where it lands, and so never leaves the window.
///   Outermost layer of the window: empty, as everything outside is.
///   Thread    simulation keeps them; contact reads copies.   Source  own derivation, shown in contact_words.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/voxel/voxmap.h"

namespace burrhole {

using ContactWord = std::uint32_t;

/// Leaps are no longer than this: it bounds how far a change spreads.
inline constexpr int kMaxLeap = 8;
/// Words further than this from each face of the window that moved stay the same in a slide.
inline constexpr int kWordSlideMargin = kMaxLeap + 1;
inline constexpr std::uint32_t kWordSolid = 128;       ///< least density of a voxel on the solid side of the 0.5 level
inline constexpr float kWordLevel = 127.5f;            ///< the 0.5 level [1/255]
inline constexpr float kWordGradient = 254.0f;         ///< steps a [density/voxel]
inline constexpr ContactWord kEmptyWord = 0x80000100;  ///< density 0, no gradient, leap 1

class ContactWords {
 public:
  /// Everything anew: the first time, or after bone grew.
  void rebuild(const MasterWindow& window);
  /// After density or gradient changed inside `dirty`. @returns the box of words that may differ now. Afterwards the words equal those of
  /// a rebuild, bit for bit.
  VoxelBox update(const MasterWindow& window, const VoxelBox& dirty);
  /// After the window slid from box() to its present place: keeps what both hold, makes what is new. Changes inside the part that is kept
  /// must be told by update() besides. Equal to a rebuild, bit for bit.
  void slide(const MasterWindow& window);

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// i fastest over box().
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
