/// core/heat/bone_cells.h: cells of n^3 voxels: which voxels a cell holds, and its share of bone. Cell c holds voxels n c to n c + n - 1.
///   Frame  index coordinates; cells.   Units  densities [-].   Errors  none.   Thread  any.
#pragma once

#include <span>

#include "core/base/geometry.h"

namespace burrhole {

class BoneCells {
 public:
  /// @param edge [voxels] >= 1.
  explicit BoneCells(int edge) : edge_(edge) {}

  /// @returns the cells that hold any voxel of a box.
  [[nodiscard]] VoxelBox cells_of(const VoxelBox& voxels) const noexcept { return {down(voxels.lo), down(voxels.hi - 1) + 1}; }
  [[nodiscard]] Vec3i cell_of(const Vec3i& voxel) const noexcept { return down(voxel); }
  /// @returns a point of index coordinates in those of the cells, whose centres are whole numbers.
  [[nodiscard]] Vec3 place_of(const Vec3& index) const noexcept {
    const auto edge = static_cast<double>(edge_);
    return (index - 0.5 * (edge - 1.0)) / edge;
  }
  [[nodiscard]] VoxelBox voxels_of(const VoxelBox& cells) const noexcept { return {cells.lo * edge_, cells.hi * edge_}; }

  /// Means of the densities of each cell's voxels. @param density over voxels_of(cells), i fastest. @param share over `cells`.
  void mean(const VoxelBox& cells, std::span<const float> density, std::span<float> share) const noexcept;

 private:
  [[nodiscard]] Vec3i down(const Vec3i& voxel) const noexcept {
    const auto floor = [this](int x) { return x >= 0 ? x / edge_ : -((edge_ - 1 - x) / edge_); };
    return {floor(voxel.x), floor(voxel.y), floor(voxel.z)};
  }
  int edge_;
};

}  // namespace burrhole
