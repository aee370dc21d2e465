/// core/voxel/triangle_patch.h: the triangles of the surface of bone in the window, as a published copy holds them, and the interface of
///   their maker. Triangles are grouped twice, so that the nearest one to a point is found in a bounded number of steps.
///   Frame  bone, relative to `origin`; boxes in index coordinates.   Units  SI.   Errors  none.
///   Thread maker: simulation; patches: as the copy that holds them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

struct MasterWindow;

/// Counter-clockwise seen from outside bone. Triangles that share a vertex have the same bits there.
struct PatchTriangle {
  std::array<Vec3f, 3> corners{};  ///< [m]
  std::array<float, 3> angles{};   ///< [rad] at the corners
  Vec3f normal{0.0f};              ///< [-] unit, out of bone
  friend bool operator==(const PatchTriangle&, const PatchTriangle&) = default;
};

/// lo > hi: holds nothing.
struct PatchBounds {
  Vec3f lo{std::numeric_limits<float>::max()}, hi{std::numeric_limits<float>::lowest()};  ///< [m]
  void include(const Vec3f& p) noexcept {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  [[nodiscard]] bool empty() const noexcept { return lo.x > hi.x; }
  friend bool operator==(const PatchBounds&, const PatchBounds&) = default;
};

/// A triangle belongs to the block of the lowest of its three voxels.
struct PatchBlock {
  std::vector<PatchTriangle> triangles;
  PatchBounds bounds;
  bool near_bone = false;  ///< a voxel of the block or within TrianglePatch::kNear of it is solid; otherwise no point of it is in bone
  friend bool operator==(const PatchBlock&, const PatchBlock&) = default;
};

struct TrianglePatch {
  static constexpr int kBlock = 4;  ///< [voxels] edge of a block
  static constexpr int kGroup = 4;  ///< [blocks] edge of a group
  static constexpr int kNear = 2;   ///< [voxels]
  /// [voxels] a triangle extends at most so far from the block of its lowest voxel: to its other voxels, and an offset to the surface.
  static constexpr int kOverhang = 3;

  VoxelBox box;                    ///< of the window; blocks begin at box.lo
  Vec3i blocks_size{0};            ///< [blocks]
  Vec3i groups_size{0};            ///< [groups]
  Vec3 origin{0.0};                ///< [m] bone frame
  Mat3 index_from_patch{1.0};      ///< [1/m] from a place relative to origin to voxels relative to box.lo
  Vec3 voxels_per_metre{0.0};      ///< [1/m] along each index axis: most voxels that a distance covers
  std::vector<PatchBlock> blocks;  ///< dense, i fastest; empty where a copy has no patch
  std::vector<PatchBounds> groups;
  std::uint64_t layout = 0;  ///< of the maker: another one has other blocks
  std::uint64_t stamp = 0;   ///< of the maker: blocks that changed later are missing here

  [[nodiscard]] VoxelBox block_box() const noexcept { return {Vec3i(0), blocks_size}; }
  [[nodiscard]] VoxelBox group_box() const noexcept { return {Vec3i(0), groups_size}; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    std::size_t sum = blocks.size() * sizeof(PatchBlock) + groups.size() * sizeof(PatchBounds);
    for (const PatchBlock& block : blocks) sum += block.triangles.size() * sizeof(PatchTriangle);
    return sum;
  }
  /// @returns the block of a voxel. @pre voxel in box.
  [[nodiscard]] Vec3i block_of(const Vec3i& voxel) const noexcept { return (voxel - box.lo) / kBlock; }
};

/// Keeps the triangles of the master window. One owner, the publisher of the window.
class TriangleSource {
 public:
  virtual ~TriangleSource() = default;
  /// After the window was loaded or moved.
  virtual void rebuild(const MasterWindow& window) = 0;
  /// After the density changed in a box. @pre rebuild() has seen this window.
  virtual void update(const MasterWindow& window, const VoxelBox& changed) = 0;
  /// Copies what changed since the copy was last brought up to date.
  virtual void bring_up_to_date(TrianglePatch& copy) const = 0;
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
};

/// Makes the source for a bone. @param bone_from_index voxel to bone frame [m].
using MakeTriangles = std::unique_ptr<TriangleSource> (*)(const Affine& bone_from_index);

}  // namespace burrhole
