/// volumes/phantom/head_bone.h: the bone model of a head phantom: voxels of spacing_mm in a region round the site, and the whole head at
///   coarser voxels for pictures.
///   Frame   bone frame of the head (head_shape.h). The axes of the grid are those of the approach: k points out of the skull.
///   Units   SI.   Errors  out_of_range of the spec; those of BoneModelBuilder.   Thread  any; uses all cores.
///   Fields  as volumes/phantom/phantom.h: occupancy is a ramp of the field of head_shape.h over its gradient; hardness and labels by the
///           depth below the vault's outer surface, as in a skull patch. Face and jaw are dense.
///   Source  own work.
#pragma once

#include <memory>

#include "core/voxel/bone_model.h"
#include "volumes/phantom/phantom_spec.h"

namespace burrhole {

/// The grids of a head. Both have a voxel at the bone's index 0, and axes in the same directions.
struct HeadGrid {
  Vec3i dims{0};           ///< [voxels] of spacing_mm round the whole head
  Affine bone_from_index;  ///< of these
  VoxelBox region;         ///< of these, the ones that hold bone; its faces are coarse voxels
  int factor = 1;          ///< [voxels] edge of a coarse voxel
  Vec3i coarse_dims{0};    ///< [coarse voxels]
};

/// @pre validate(spec) found no error.
[[nodiscard]] HeadGrid head_grid(const PhantomSpec& spec);

/// Only voxels of the region hold bone; the rest of the head is in BoneModel::surroundings(). The same spec gives the same bits on every
/// machine.
[[nodiscard]] Result<std::shared_ptr<const BoneModel>> make_head_bone(const PhantomSpec& spec, const BoneStorage& storage = {});

}  // namespace burrhole
