/// core/voxel/saved_remaining.h: the grid `remaining` of a .vdb as blocks.
///   Frame  index.   Units  remaining [-]: 1 as loaded .. 0 removed.   Errors  bad_input with the path.   Thread  any.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/voxel/block_store.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

inline constexpr const char* kRemainingGrid = "remaining";

/// @returns the blocks of a grid that differ from 1. bad_input: the background is not 1, a value is outside 0..1 or not finite, or a voxel is
/// farther than 512 voxels from the bone. @param path for the error. @param bone the box of the bone.
[[nodiscard]] Result<BlockStore> saved_remaining(const FloatVdb& grid, const VoxelBox& bone, const std::string& path);

}  // namespace burrhole
