/// tests/core/voxel/voxel_cases.h: small random bones, and a slow plain twin of the voxmap that shares no code with it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/voxel/voxmap.h"

namespace burrhole::test {

/// Random occupancy (a third 0, a third 1, a third between), hardness and labels.
[[nodiscard]] DenseBone random_bone(const Vec3i& dims, std::uint64_t seed);
[[nodiscard]] std::shared_ptr<const BoneModel> load_bone(const DenseBone& dense);
[[nodiscard]] Voxmap make_voxmap(std::shared_ptr<const BoneModel> bone, float dead_zone = 0.08f);

/// Whole number in [0, below), from a seed and a counter that is advanced.
struct Dice {
  std::uint64_t seed = 1;
  std::uint64_t counter = 0;
  [[nodiscard]] double next();
  [[nodiscard]] int next_below(int below);
  /// Box with edges in [1, longest] inside `inside`.
  [[nodiscard]] VoxelBox box_inside(const VoxelBox& inside, int longest);
};

/// Keeps occupancy as given and every remaining value as the test wrote it, one by one; answers by plain arithmetic from the definitions.
class PlainTwin {
 public:
  PlainTwin(const DenseBone& dense, float dead_zone);
  [[nodiscard]] float remaining(const Vec3i& v) const;
  void set_remaining(const Vec3i& v, float value);
  [[nodiscard]] float density(const Vec3i& v) const;       ///< 0 outside the grid
  [[nodiscard]] Vec3f gradient(const Vec3i& v) const;      ///< central differences, index axes, zero below the dead zone
  [[nodiscard]] VoxelBox reach() const { return reach_; }  ///< where remaining may be written: the grid and 16 voxels round it

 private:
  VoxelBox grid_, reach_;
  float dead_zone_;
  std::vector<float> occupancy_, remaining_;
};

/// Gives every voxel of the box a random remaining (a third 0, a third as it was, a third a fraction of it), in voxmap and twin,
/// and commits.
void erode_box(Voxmap& voxmap, PlainTwin& twin, const VoxelBox& box, Dice& dice);
/// Box of a random window, 8 to 20 voxels an edge, that may reach outside the grid.
[[nodiscard]] VoxelBox random_window(const VoxelBox& grid, Dice& dice);

/// Float gradients over the whole window.
[[nodiscard]] std::vector<Vec3f> gradients_of(const MasterWindow& window);
/// @returns what differs first between the window and a full rebuild by the twin, bit for bit; empty if nothing.
[[nodiscard]] std::string difference(const MasterWindow& window, const PlainTwin& twin);
/// @returns the first voxel inside both boxes whose density or gradient changed and that none of `dirty` covers; empty if all are covered.
[[nodiscard]] std::string uncovered_change(const MasterWindow& before, const MasterWindow& after, std::span<const VoxelBox> dirty);

}  // namespace burrhole::test
