/// core/drill/erosion_memory.h: predicts the memory of erosion in a run that drills along a straight line.
///   Frame  as named.   Units  bytes; SI.   Errors  none.   Thread  any; allocates.
///   Source own derivation: sizes of the arrays of Erosion, and the blocks of the cut surface that the cutting part passes.
#pragma once

#include <cstdint>

#include "core/drill/erosion.h"

namespace burrhole {

/// The straight line along which a tool drills.
struct DrillingWay {
  Affine index_from_tool;  ///< with the tip at the entry
  Vec3 along{0.0};         ///< [voxels] from the entry to the deepest place of the tip, index coordinates
};

/// @returns the number of blocks of the cut surface that a run adds: those with a voxel within the band of known distances of the cutting
/// part, on its way from the entry.
[[nodiscard]] std::uint64_t count_cut_blocks(const CuttingField& field, const DrillingWay& way, double voxel_edge);

/// @returns the largest memory of erosion: the cutting field, the cut surface and the lists of the faces' nodes of sub-voxel removal, or
/// the points and the sums by voxel of removal by whole voxels. @param window_voxels of the master window.
[[nodiscard]] std::uint64_t erosion_bytes(const ErosionConfig& config, const Tool& tool, const DrillingWay& way, double voxel_edge,
                                          std::uint64_t window_voxels);

}  // namespace burrhole
