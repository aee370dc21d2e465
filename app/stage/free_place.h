/// app/stage/free_place.h: where a tool goes when bone comes back round it, as by an undo, or when a wider tool takes its place: back along its
///   shaft, the way it came.
///   Frame  world.   Units  SI.   Errors  none: a voxel that cannot be read counts as empty, and BoneModel::read_status() reports it.
///   Thread  simulation, while no clock runs: it allocates.   Source  own work.
#pragma once

#include "core/base/geometry.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Moves the tool from outside along its shaft (-z of the tool) towards `world_from_tool`, in steps of a voxel, until the next step would take a
/// point of its shell into bone. A point may be in bone by three quarters of a voxel, as the flank of a bit is in the wall of its hole.
/// @param from [m] distance behind `world_from_tool` at which it begins; where bone is there, it begins outside the grid of the bone.
/// @returns the last pose without such a point: `world_from_tool` itself where the whole way is free.
[[nodiscard]] Pose place_free_of_bone(const Voxmap& bone, const Pose& world_from_bone, const Tool& tool, const Pose& world_from_tool,
                                      double from);

}  // namespace burrhole
