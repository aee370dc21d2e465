/// core/voxel/surface_memory.h: predicts the memory in which the surface records of a window are made (surface_records.h).
///   Frame  index, bone.   Units  bytes.   Errors  none.   Thread  any.   Source  own derivation: the arrays of SurfaceTile::lay_out(), of a cube.
#pragma once

#include <cstdint>

#include "core/base/geometry.h"

namespace burrhole {

/// @param window_voxels of the largest window. @returns the bytes of the scratch of SurfaceRecords, which stays at its largest size: that of one tile of a window.
[[nodiscard]] std::uint64_t record_scratch_bytes(std::uint64_t window_voxels, const Affine& bone_from_index) noexcept;

}  // namespace burrhole
