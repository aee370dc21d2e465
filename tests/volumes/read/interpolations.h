/// tests/volumes/read/interpolations.h: interpolations of a scan that were compared, each on its own and for small scans.
///   Units of the scan.   Errors none.   Thread any.
#pragma once

#include "volumes/read/scan.h"

namespace burrhole::test {

enum class Kernel {
  linear,
  catmull_rom,
  cubic6,         ///< cubic convolution of six samples [Keys81]
  spline,         ///< interpolating cubic B-spline
  smooth_spline,  ///< cubic B-spline without prefilter: a low pass
  lanczos,        ///< windowed sinc of six samples
};

/// @returns the values at cubes of `spacing` [m], spanning the scan; the axes of the scan are those of the bone frame.
[[nodiscard]] Scan interpolate(const Scan& scan, double spacing, Kernel in_slice, Kernel across);

/// Shape-based: signed distance in each slice from the contour of `level`, interpolated by Catmull-Rom [RayaUdupa90]. Values are
/// `level` + `slope` [1/m] times the distance.
[[nodiscard]] Scan distances_of(const Scan& scan, double level, double slope);

}  // namespace burrhole::test
