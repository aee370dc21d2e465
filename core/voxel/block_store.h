/// core/voxel/block_store.h: a sparse field of floats in dense blocks of 8^3 voxels. A voxel without a block has the value 1.
///   Frame   index; block (a, b, c) covers voxels 8a..8a+7, 8b..8b+7, 8c..8c+7; values in a block i fastest.
///   Thread  one. Adding a block allocates memory unless enough is reserved; reading never allocates.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kBlockEdge = 8;
inline constexpr std::size_t kBlockVoxels = 512;
using BlockValues = std::array<float, kBlockVoxels>;

[[nodiscard]] inline Vec3i block_of(const Vec3i& voxel) noexcept { return {voxel.x >> 3, voxel.y >> 3, voxel.z >> 3}; }
[[nodiscard]] inline VoxelBox box_of_block(const Vec3i& block) noexcept { return {block * kBlockEdge, (block + 1) * kBlockEdge}; }
/// @returns the box of blocks that intersect a box of voxels.
[[nodiscard]] inline VoxelBox blocks_of(const VoxelBox& box) noexcept {
  return box.empty() ? VoxelBox{} : VoxelBox{block_of(box.lo), block_of(box.hi - 1) + 1};
}

/// @returns the block coordinates packed into one integer. Keys sort by k, then j, then i. Requires each coordinate in [-2^20, 2^20).
[[nodiscard]] inline std::uint64_t key_of_block(const Vec3i& block) noexcept {
  const auto part = [](int x) { return static_cast<std::uint64_t>(std::int64_t{x} + (1 << 20)); };
  return (part(block.z) << 42) | (part(block.y) << 21) | part(block.x);
}
[[nodiscard]] inline Vec3i block_of_key(std::uint64_t key) noexcept {
  const auto part = [&](int shift) { return static_cast<int>((key >> shift) & 0x1fffff) - (1 << 20); };
  return {part(0), part(21), part(42)};
}

/// Memory pool of blocks, in chunks whose addresses are stable. The values of a newly taken block are undefined.
class BlockPool {
 public:
  using Index = std::uint32_t;
  static constexpr std::size_t kChunk = 64;  ///< blocks that are allocated together

  /// Reserves memory for `blocks` blocks in total, rounded up to whole chunks, and writes it: its pages are resident then.
  void reserve(std::size_t blocks);
  /// @returns a free block; allocates a chunk if there is none.
  [[nodiscard]] Index take();
  void give_back(Index block) noexcept { free_.push_back(block); }  // within its capacity
  [[nodiscard]] BlockValues& operator[](Index block) noexcept { return chunks_[block / kChunk][block % kChunk]; }
  [[nodiscard]] const BlockValues& operator[](Index block) const noexcept { return chunks_[block / kChunk][block % kChunk]; }
  [[nodiscard]] std::size_t capacity() const noexcept { return chunks_.size() * kChunk; }
  [[nodiscard]] std::size_t in_use() const noexcept { return capacity() - free_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  std::vector<std::unique_ptr<BlockValues[]>> chunks_;
  std::vector<Index> free_;
};

/// A block in a sorted list.
struct BlockEntry {
  std::uint64_t key;
  BlockPool::Index index;
};

class BlockStore {
 public:
  /// Reserves memory for `blocks` blocks: up to this number, put() allocates nothing.
  void reserve(std::size_t blocks);
  /// @returns the values of a block; null if it is not stored, in which case all its voxels are 1.
  [[nodiscard]] const BlockValues* find(const Vec3i& block) const noexcept;
  /// Adds a block, or replaces its values.
  void put(const Vec3i& block, const BlockValues& values);
  void erase(const Vec3i& block) noexcept;
  void clear() noexcept;

  /// Dense copy of a box, i fastest; out.size() == box.count().
  void read_box(const VoxelBox& box, std::span<float> out) const noexcept;
  /// Calls f(block, values) for each block, sorted by k, j, i.
  template <class F>
  void for_each_block(F&& f) const {
    for (const BlockEntry& entry : entries_) f(block_of_key(entry.key), pool_[entry.index]);
  }
  /// Calls f(voxel, value) for each voxel that is not 1, sorted by k, j, i.
  template <class F>
  void for_each_sorted(F&& f) const {
    std::vector<float> slab;  // a layer of blocks keeps the sort in bounded memory
    for (std::size_t first = 0; first < entries_.size();) {
      const VoxelBox part = layer_at(first);
      slab.resize(part.count());
      read_box(part, slab);
      std::size_t n = 0;
      for_each_voxel(part, [&](const Vec3i& v) {
        const float value = slab[n++];
        if (value != 1.0f) f(v, value);
      });
    }
  }
  /// @returns the bounding box of all voxels that are not 1.
  [[nodiscard]] VoxelBox changed_bounds() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }  ///< blocks
  [[nodiscard]] std::size_t bytes() const noexcept { return pool_.bytes() + entries_.capacity() * sizeof(BlockEntry); }

 private:
  /// @returns the bounding box of the blocks of the layer that begins at entry `first`; advances `first` to the next layer.
  [[nodiscard]] VoxelBox layer_at(std::size_t& first) const noexcept;

  std::vector<BlockEntry> entries_;  // sorted by key
  BlockPool pool_;
};

/// The set of blocks of a window that were written, one bit per block.
class BlockMarks {
 public:
  /// Clears all marks and sets the window's box. Allocates nothing for windows that fits_window().
  void reset(const VoxelBox& window);
  void mark(const VoxelBox& box) noexcept;
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  /// Calls f(block) for each marked block, sorted by k, j, i, and clears the marks.
  template <class F>
  void take(F&& f) {
    for (std::size_t word = 0; count_ > 0 && word < bits_.size(); ++word)
      for (; bits_[word] != 0; bits_[word] &= bits_[word] - 1, --count_) f(block_at(64 * word + lowest(bits_[word])));
  }

 private:
  [[nodiscard]] static std::size_t lowest(std::uint64_t bits) noexcept { return static_cast<std::size_t>(std::countr_zero(bits)); }
  [[nodiscard]] Vec3i block_at(std::size_t n) const noexcept;

  VoxelBox blocks_;  // in blocks
  std::vector<std::uint64_t> bits_;
  std::size_t count_ = 0;
};

}  // namespace burrhole
