/// volumes/read/scan_geometry.h: what an affine says in words, and whether it is usable.
///   Frame bone frame (LPS), index axes i, j, k.   Units SI, angles in rad.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/geometry.h"

namespace burrhole {

struct GridShape {
  Vec3 spacing{0.0};      ///< [m] lengths of the three columns
  Mat3 direction{1.0};    ///< unit columns: where i, j, k point
  double shear = 0.0;     ///< [rad] largest departure of an angle between two index axes from a right angle (gantry tilt shows here)
  double oblique = 0.0;   ///< [rad] largest angle between an index axis and its nearest patient axis
  bool mirrored = false;  ///< left-handed index axes
};

[[nodiscard]] GridShape describe_grid(const Affine& bone_from_index) noexcept;

/// @returns what is wrong with an affine as a voxel map (not finite, flat, edges outside 1 um .. 1 m), or nothing.
[[nodiscard]] std::optional<std::string> affine_fault(const Affine& bone_from_index);

/// What is wrong with sizes as those of a volume (an edge under 1 or beyond int, more voxels than kMaxScanVoxels), or nothing.
[[nodiscard]] std::optional<std::string> dims_fault(std::int64_t i, std::int64_t j, std::int64_t k);

/// Patient RAS (NIfTI) to LPS: x and y change sign.
[[nodiscard]] Affine lps_from_ras(const Affine& ras_from_index) noexcept;

}  // namespace burrhole
