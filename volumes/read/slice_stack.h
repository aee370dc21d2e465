/// volumes/read/slice_stack.h: computes one affine from the positions of single slices; sorts and checks them, keeps the tilt.
///   Frame LPS.   Units mm in, as in DICOM; the affine is in m.   Errors bad_input.
///   Source DICOM PS3.3 C.7.6.2 (image plane); checks are our own.
#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// One slice as described by its header.
struct SlicePlane {
  Vec3 position{0.0};           ///< [mm] centre of the first pixel (ImagePositionPatient)
  Vec3 row{1.0, 0.0, 0.0};      ///< [-] direction of increasing column index i (first triplet of ImageOrientationPatient)
  Vec3 column{0.0, 1.0, 0.0};   ///< [-] direction of increasing row index j
  double column_spacing = 1.0;  ///< [mm] between columns, along `row` (second value of PixelSpacing)
  double row_spacing = 1.0;     ///< [mm] between rows, along `column` (first value of PixelSpacing)
  int columns = 0, rows = 0;    ///< [pixels]
};

struct SliceStack {
  std::vector<std::size_t> order;  ///< indices of the input, along the slice normal
  Affine bone_from_index;          ///< [m]; the third column is the mean step from slice to slice, including tilt
  double tilt = 0.0;               ///< [rad] angle between that step and the slice normal
};

/// @param single_slice_mm [mm] spacing for a stack of one slice.
/// @returns bad_input with the numbers: no slices; values that are not finite; rows and columns that are not perpendicular unit vectors;
/// mixed orientations, sizes or pixel spacings; two slices at one position; gaps (a slice step that differs from the median by more than 1
/// % + 0.01 mm); uneven drift (a slice more than a tenth of the shortest voxel edge + 0.01 mm off its position in the affine).
[[nodiscard]] Result<SliceStack> stack_slices(const std::vector<SlicePlane>& slices, double single_slice_mm);

}  // namespace burrhole
