/// core/voxel/cut_surface.h: the surface of bone near every place where a tool has cut, one node per voxel: distance and normal.
///   Where a node is set, it replaces the record that would be computed from the density. Erosion writes it; it is finer than the density
///   can represent, and its 0 level is the 0.5 level of the density.
///   Frame  nodes at voxel centres, in blocks of 8^3; normals in the axes of the bone frame.   Units  [voxel unit] in voxel edges
///   (bone_from_index.mean_edge()).   Errors  none.   Thread  one, the simulation.   Source  own derivation (core/drill/cut_face.h).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>

#include "core/voxel/block_store.h"

namespace burrhole {

class CutSurface {
 public:
  /// Distance of a node that is not set.
  static constexpr float kUnset = std::numeric_limits<float>::max();

  /// The normal is that of the nearer surface. A node inside bone that is nearly as near to a cut face has the normal of that one: contact
  /// interpolates normals, and beside a cut face they must belong to it.
  struct Node {
    float base = kUnset;                   ///< [voxel unit] to the surface as it was when the node was set, positive outside bone
    float cut = -kUnset;                   ///< [voxel unit] to the faces cut since
    std::array<std::int16_t, 3> normal{};  ///< [steps] of kRecord16Normal, outward; zero: unknown
    std::int16_t normal_at = 0;            ///< [steps] of kRecord16Distance: `cut` when the normal was computed
    [[nodiscard]] bool set() const noexcept { return base != kUnset; }
    /// @returns the distance to bone as it is [voxel unit].
    [[nodiscard]] float distance() const noexcept { return base > cut ? base : cut; }
  };
  struct Block {
    std::array<Node, kBlockVoxels> nodes;
    bool complete = false;  ///< every node is set
    bool free = false;      ///< no node will change any more
    [[nodiscard]] Node& at(const Vec3i& voxel) noexcept { return nodes[place(voxel)]; }
    [[nodiscard]] const Node& at(const Vec3i& voxel) const noexcept { return nodes[place(voxel)]; }

   private:
    [[nodiscard]] static std::size_t place(const Vec3i& v) noexcept {
      const int at = ((v.z & 7) * kBlockEdge + (v.y & 7)) * kBlockEdge + (v.x & 7);
      return static_cast<std::size_t>(at);
    }
  };

  /// @returns the block, added if it is new.
  [[nodiscard]] Block& add(const Vec3i& block) {
    auto& found = blocks_[key_of_block(block)];
    if (!found) {
      found = std::make_unique<Block>();
      box_ = box_.unite(box_of_block(block));
    }
    return *found;
  }
  /// @returns the block, or null.
  [[nodiscard]] const Block* find(const Vec3i& block) const noexcept {
    const auto found = blocks_.find(key_of_block(block));
    return found == blocks_.end() ? nullptr : found->second.get();
  }
  [[nodiscard]] Block* find(const Vec3i& block) noexcept { return const_cast<Block*>(std::as_const(*this).find(block)); }
  [[nodiscard]] bool empty() const noexcept { return blocks_.empty(); }
  /// @returns a box that holds every block.
  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  void clear() noexcept {
    blocks_.clear();
    box_ = {};
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return blocks_.size() * (sizeof(Block) + 4 * sizeof(void*)); }

 private:
  std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks_;
  VoxelBox box_;
};

}  // namespace burrhole
