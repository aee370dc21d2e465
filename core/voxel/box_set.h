/// core/voxel/box_set.h: a few disjoint boxes that cover what changed, and the marks they are made from.
///   Units  voxels, index coordinates.   Thread  one.   Source  own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// At most kMax disjoint boxes, none of them empty. A value: copied freely, never allocates.
class BoxSet {
 public:
  static constexpr std::size_t kMax = 16;

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const VoxelBox* begin() const noexcept { return boxes_.data(); }
  [[nodiscard]] const VoxelBox* end() const noexcept { return boxes_.data() + count_; }
  [[nodiscard]] std::span<const VoxelBox> boxes() const noexcept { return {boxes_.data(), count_}; }
  /// The box round all of them.
  [[nodiscard]] VoxelBox bounds() const noexcept;
  /// Voxels in all of them.
  [[nodiscard]] std::size_t voxels() const noexcept;
  [[nodiscard]] bool contains(const Vec3i& v) const noexcept;
  friend bool operator==(const BoxSet& a, const BoxSet& b) noexcept { return std::ranges::equal(a.boxes(), b.boxes()); }

 private:
  friend class TileMarks;
  std::array<VoxelBox, kMax> boxes_{};
  std::size_t count_ = 0;
};

/// Marks of single voxels of a window, kept by tiles of 8^3 counted from the window's corner: which rows, columns and slabs of a tile hold
/// a mark. From them a set of boxes that follows the shape of a ring or a saw instead of filling its middle.
class TileMarks {
 public:
  static constexpr int kEdge = 8;
  /// Bit n of x is set when a voxel with x = n within the tile is marked; y and z likewise.
  struct Tile {
    std::uint8_t x = 0, y = 0, z = 0;
  };

  /// Clears all marks and takes over the window's box (kMaxWindowEdge bounds it).
  void reset(const VoxelBox& window);
  /// Marks the voxels at.x + n of row (at.y, at.z) whose bit n is set. `at` relative to the window, at.x a multiple of 8.
  void mark(const Vec3i& at, std::uint32_t bits) {
    if (bits == 0) return;
    const std::uint32_t index = static_cast<std::uint32_t>(at.x >> 3) +
                                tiles_.x * (static_cast<std::uint32_t>(at.y >> 3) + tiles_.y * static_cast<std::uint32_t>(at.z >> 3));
    Tile& tile = marks_[index];
    if (tile.x == 0) touched_.push_back(index);
    tile.x = static_cast<std::uint8_t>(tile.x | bits);
    tile.y = static_cast<std::uint8_t>(tile.y | (1u << (at.y & 7)));
    tile.z = static_cast<std::uint8_t>(tile.z | (1u << (at.z & 7)));
  }
  /// Disjoint boxes that hold every mark. Neighbours are joined where that costs no more voxels, halo of one included, than it saves.
  [[nodiscard]] BoxSet boxes();

 private:
  struct Brick {
    Vec3i lo, hi;    // in tiles
    VoxelBox tight;  // of the marks in it
  };
  [[nodiscard]] VoxelBox tight_box(std::uint32_t index) const;
  void join_rows(std::size_t axis);
  void coarsen();
  void join_cheapest();
  void absorb(std::size_t a, std::size_t b);

  VoxelBox window_;
  glm::uvec3 tiles_{0};
  std::vector<Tile> marks_;
  std::vector<std::uint32_t> touched_;
  std::vector<Brick> bricks_;
};

}  // namespace burrhole
