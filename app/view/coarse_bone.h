/// app/view/coarse_bone.h: a bone at coarser voxels, for pictures of a bone that is too large for one texture.
///   Grid    A coarse voxel lies at every `factor`-th voxel of the bone on each axis, from voxel 0 on.
///   Density The mean of the densities around it, with the weights (1 - |d| / factor) / factor per axis, d in voxels of the bone, |d| < factor.
///           The weights add up to 1 and are symmetric, so a plane 0.5 surface stays where it is.
///   Frame   `box` is in voxels of the bone, `coarse` in coarse voxels.   Errors  bad_input.
///   Thread  any while the bone does not change.   Source  own work; the weights are those of full weighting in multigrid methods.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "app/view/drawn_bone.h"
#include "core/base/result.h"

namespace burrhole {

class CoarseBone {
 public:
  /// @param factor at least 2. bad_input: BoneModelBuilder::create.
  [[nodiscard]] static Result<CoarseBone> create(const BoneModel& bone, int factor);
  /// @returns the surroundings of a bone.
  [[nodiscard]] static CoarseBone around(const Surroundings& surroundings) {
    CoarseBone out(surroundings.coarse, surroundings.factor);
    out.surrounds_ = true;
    return out;
  }

  [[nodiscard]] const BoneModel& loaded() const noexcept { return *loaded_; }
  [[nodiscard]] int factor() const noexcept { return factor_; }
  /// @returns the size of the coarse grid [voxels].
  [[nodiscard]] static Vec3i dims_of(const Vec3i& dims, int factor) noexcept { return (dims - 1 + factor - 1) / factor + 1; }
  /// @returns the coarse voxels whose density depends on the voxels of `box`.
  [[nodiscard]] VoxelBox coarse_of(const VoxelBox& box) const noexcept;
  /// The present density of coarse voxels: the same bits for any partition of a box.
  void read_density(const Voxmap& voxmap, const VoxelBox& coarse, std::span<float> out) const;
  /// @pre `voxmap` is of the bone of create(); it and this object outlive the result.
  [[nodiscard]] DrawnBone drawn(const Voxmap& voxmap) const;

 private:
  CoarseBone(std::shared_ptr<const BoneModel> loaded, int factor) : loaded_(std::move(loaded)), factor_(factor) {}
  /// @param density of the voxels on which `part` depends. @param coarse box of `out`, which holds the bone as loaded.
  void subtract_removed(const BoneModel& bone, const VoxelBox& part, std::vector<float> density, const VoxelBox& coarse,
                        std::span<float> out) const;
  std::shared_ptr<const BoneModel> loaded_;
  int factor_;
  bool surrounds_ = false;  // loaded_ is not the mean of the bone
};

}  // namespace burrhole
