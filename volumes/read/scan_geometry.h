/// volumes/read/scan_geometry.h: spacing, direction, shear and obliquity of an affine, and checks that it is usable.
///   Frame bone frame (LPS), index axes i, j, k.   Units SI, angles in rad.   Errors  one line of text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/geometry.h"

namespace burrhole {

struct GridShape {
  Vec3 spacing{0.0};      ///< [m] lengths of the three columns
  Mat3 direction{1.0};    ///< [-] unit columns: directions of i, j, k
  double shear = 0.0;     ///< [rad] largest deviation of the angle between two index axes from a right angle (gantry tilt)
  double oblique = 0.0;   ///< [rad] largest angle between an index axis and its nearest patient axis
  bool mirrored = false;  ///< left-handed index axes
};

[[nodiscard]] GridShape describe_grid(const Affine& bone_from_index) noexcept;

/// @returns the error of an affine as a voxel map (not finite, flat, edges outside 1 um .. 1 m), or nothing.
[[nodiscard]] std::optional<std::string> affine_error(const Affine& bone_from_index);

/// @returns the error of the sizes of a volume (an edge below 1 or beyond int, more voxels than kMaxScanVoxels), or nothing.
[[nodiscard]] std::optional<std::string> dims_error(std::int64_t i, std::int64_t j, std::int64_t k);

/// @returns the map to LPS from a map to RAS (NIfTI): x and y change sign.
[[nodiscard]] Affine lps_from_ras(const Affine& ras_from_index) noexcept;

}  // namespace burrhole
