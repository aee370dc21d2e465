/// core/mesh/solid_bits.h: which voxels of a box are bone, one bit each, with a layer of empty voxels round the box.
///   Index   of a voxel or of a cell by its lowest corner; a step to a neighbour is a constant difference, so no neighbour needs a check of
///     the box. Rows begin at words of 64 bits.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  one writer.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

class SolidBits {
 public:
  SolidBits() = default;
  /// All voxels empty. @pre box not empty.
  explicit SolidBits(const VoxelBox& box);

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// @pre v in box().grown(1).
  [[nodiscard]] std::size_t index_of(const Vec3i& v) const noexcept {
    const Vec3i d = v - box_.lo + 1;
    return static_cast<std::size_t>(d.x) + row_ * static_cast<std::size_t>(d.y) + slab_ * static_cast<std::size_t>(d.z);
  }
  [[nodiscard]] Vec3i voxel_at(std::size_t index) const noexcept {
    return box_.lo - 1 + Vec3i(static_cast<int>(index % row_), static_cast<int>(index % slab_ / row_), static_cast<int>(index / slab_));
  }
  [[nodiscard]] std::size_t index_end() const noexcept { return words_.size() * 64; }
  /// @returns the difference of indices of a step to a neighbour. @param code of step_code().
  [[nodiscard]] std::size_t step(unsigned code) const noexcept { return steps_[code]; }

  [[nodiscard]] bool at(std::size_t index) const noexcept { return (words_[index >> 6] >> (index & 63) & 1u) != 0; }
  void set(std::size_t index, bool solid) noexcept {
    const std::uint64_t bit = std::uint64_t{1} << (index & 63);
    words_[index >> 6] = solid ? words_[index >> 6] | bit : words_[index >> 6] & ~bit;
  }
  /// @returns the corners of a cell: bit n is set if cell_corner(n) is solid. @param index of its lowest corner.
  [[nodiscard]] unsigned corners(std::size_t index) const noexcept {
    unsigned out = 0;
    for (unsigned n = 0; n < 8; ++n) out |= static_cast<unsigned>(at(index + corner_steps_[n])) << n;
    return out;
  }
  [[nodiscard]] std::size_t corner_step(unsigned n) const noexcept { return corner_steps_[n]; }
  /// @returns the indices of all cells with both solid and empty corners, in ascending order.
  [[nodiscard]] std::vector<std::size_t> mixed_cells() const;
  [[nodiscard]] std::size_t bytes() const noexcept { return words_.capacity() * sizeof(std::uint64_t); }

 private:
  VoxelBox box_;
  std::size_t row_ = 64, slab_ = 64;           // [bits]
  std::array<std::size_t, 27> steps_{};        // [bits] modulo 2^64
  std::array<std::size_t, 8> corner_steps_{};  // [bits]
  std::vector<std::uint64_t> words_;
};

}  // namespace burrhole
