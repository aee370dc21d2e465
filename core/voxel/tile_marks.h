/// core/voxel/tile_marks.h: marks of changed voxels, and a small set of disjoint boxes that covers them.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  one.   Source  own.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box_list.h"

namespace burrhole {

/// Marks of single voxels of a window, stored per tile of 8^3 voxels: which x, y and z positions of the tile have a mark. Tiles start at
/// the window's corner. The boxes follow the shape of a ring or a saw cut instead of covering its interior.
class TileMarks {
 public:
  static constexpr int kEdge = 8;
  /// Bit n of x is set when a voxel with x = n within the tile is marked; y and z likewise.
  struct Tile {
    std::uint8_t x = 0, y = 0, z = 0;
  };

  /// Clears all marks and sets the window's box, whose edges are at most kMaxWindowEdge.
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
  /// @returns disjoint boxes that contain every mark. Adjacent boxes are joined if this does not increase the number of voxels to process,
  /// including a halo of one voxel.
  [[nodiscard]] VoxelBoxes boxes();

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
