/// core/measure/largest_part.h: the largest connected part of the bone as loaded. A scan may hold others: a headrest, a tube, a loose chip.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any; reads the bone alone.   Memory  a byte per 1.5 mm cube of the volume.
///   Parts  cubes of 1.5 mm that hold bone, and share a face with another one. So parts less than 1.5 mm apart are one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/voxel/bone_model.h"

namespace burrhole {

class LargestPart {
 public:
  explicit LargestPart(const BoneModel& bone);
  /// The voxels round it, to whole cubes; empty without bone.
  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// Its voxels of bone, and the box round them.
  struct Extent {
    VoxelBox box;
    std::uint64_t voxels = 0;
  };
  /// @returns its extent to the voxel. @param bone the one of the constructor, which is read once more.
  [[nodiscard]] Extent extent(const BoneModel& bone) const;
  /// @returns whether a point lies in it or less than a cube beside it.
  [[nodiscard]] bool is_near(const Vec3& index) const noexcept;

 private:
  void mark_bone(const BoneModel& bone);
  /// Joins the part that begins in a cube. @returns its cubes.
  std::vector<std::size_t> take_part(std::size_t first);

  Vec3i cube_{1};  // [voxels]
  VoxelBox cubes_;
  std::vector<std::uint8_t> state_;
  VoxelBox box_;
};

}  // namespace burrhole
