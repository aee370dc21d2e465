/// core/voxel/cut_surface.h: the surface of bone near every place where a tool has cut, one node per voxel: distance and normal.
///   A node that is set replaces the surface record of its voxel, which would otherwise be computed from the density. Sub-voxel erosion
///   writes the nodes. They resolve the surface more finely than the density does; their 0 level is its 0.5 level.
///   Frame  nodes at voxel centres, in blocks of 8^3; normals in the axes of the bone frame.   Units  [voxel unit] in voxel edges
///   (bone_from_index.mean_edge()).   Errors  none.   Thread  one, the simulation.   Source  own derivation (core/drill/cut_face.h).
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>

#include "core/voxel/block_store.h"
#include "core/voxel/surface_record.h"

namespace burrhole {

class CutSurface {
 public:
  /// Distance of a node that is not set.
  static constexpr float kUnset = std::numeric_limits<float>::max();

  /// Distances of one voxel. Bone is bounded by its surface before the cut and by the cut faces, so the larger of the two signed distances
  /// applies.
  struct Node {
    float base = kUnset;  ///< [voxel unit] signed distance to the surface when the node was set, positive outside bone
    float cut = -kUnset;  ///< [voxel unit] signed distance to the faces cut since; -kRecordBand or less: none is near
    [[nodiscard]] bool set() const noexcept { return base != kUnset; }
    /// @returns the signed distance to the present surface of bone [voxel unit].
    [[nodiscard]] float distance() const noexcept { return base > cut ? base : cut; }
  };
  /// The nodes of 8^3 voxels, i fastest, as arrays.
  struct Block {
    alignas(64) std::array<float, kBlockVoxels> base, cut;  ///< [voxel unit] of Node
    /// The record of the voxel: Node::distance() within the band, and the normal of the nearer surface. Exception: a node inside bone has the
    /// normal of the cut face also where `cut` is up to one voxel edge smaller than `base`. Contact interpolates normals between nodes, and
    /// beside a cut face all of them must belong to that face.
    std::array<Record16, kBlockVoxels> record{};
    /// [steps] of kRecord16Distance: value of `cut` for which the normal was computed; 0: not yet
    std::array<std::int16_t, kBlockVoxels> normal_at{};
    std::bitset<kBlockVoxels> cut_before;  ///< the voxel had lost bone when the node was set
    bool complete = false;                 ///< every node is set
    bool free = false;                     ///< no node will change any more
    Block() noexcept {
      base.fill(kUnset);
      cut.fill(-kUnset);
    }
    [[nodiscard]] Node at(const Vec3i& voxel) const noexcept {
      const std::size_t n = place(voxel);
      return {base[n], cut[n]};
    }
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
