/// volumes/read/slice_stack.h: from the positions of single slices to one affine: sorted, checked, tilt kept. Knows no file format.
///   Frame LPS.   Units mm in, as DICOM has them; the affine is in m.   Source DICOM PS3.3 C.7.6.2 (image plane); checks are our own.
#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// One slice as its header describes it.
struct SlicePlane {
  Vec3 position{0.0};           ///< [mm] centre of the first pixel (ImagePositionPatient)
  Vec3 row{1.0, 0.0, 0.0};      ///< direction of increasing column index i (first triplet of ImageOrientationPatient)
  Vec3 column{0.0, 1.0, 0.0};   ///< direction of increasing row index j
  double column_spacing = 1.0;  ///< [mm] between columns, along `row` (second value of PixelSpacing)
  double row_spacing = 1.0;     ///< [mm] between rows, along `column` (first value of PixelSpacing)
  int columns = 0, rows = 0;
};

struct SliceStack {
  std::vector<std::size_t> order;  ///< indices of the input, along the slice normal
  Affine bone_from_index;          ///< [m]; the third column is the mean step from slice to slice, tilt included
  double tilt = 0.0;               ///< [rad] angle of that step to the slice normal
};

/// `single_slice_mm`: spacing for a stack of one slice. @returns bad_input that names the fault with its numbers: no slices, values not
/// finite, rows and columns that are not perpendicular unit vectors, mixed orientations, sizes or pixel spacings, two slices at one place,
/// gaps (slice step off the median, which gaps do not move, by more than 1 % + 0.01 mm: how many, where), drift that is uneven (a slice
/// more than a tenth of the shortest voxel edge + 0.01 mm off its place in the affine).
[[nodiscard]] Result<SliceStack> stack_slices(const std::vector<SlicePlane>& slices, double single_slice_mm);

}  // namespace burrhole
