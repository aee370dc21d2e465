/// core/drill/coverage_samples.h: 64 places in and round a voxel that stand for it when its coverage by a tool is measured.
///   Frame  index coordinates, relative to the voxel's centre.   Source  own derivation:
///   Coverage is the share of the samples inside the tool: the tool's solid, averaged over a kernel. Along each axis the samples have 64
///   distinct levels of equal weight, so that an axis-aligned wall moves in steps of 1/64; which level of y and z goes with which of x was
///   found by simulated annealing of the largest error over half-spaces of any tilt and over small balls on the grid of voxels.
///   Kernels along an axis, all of which add up to 1 over the voxels (removed mass is the swept volume), and what a 0.5 level, read by linear
///   interpolation, makes of a level wall, whose offset from the voxel's centre is t:
///     cell       1 on +-1/2: off by up to 0.086 voxel (t = 0.25 and 0.75); the sharpest, variance 1/12.
///     trapezoid  3/4 on +-1/2, 1/4 on to +-1, between the two others: off by up to 0.05 voxel; variance 5/24.
///     wide       1/2 on +-1: exact, as in volumes/phantom/phantom.h; variance 1/3.
///   On a surface with radii R1 and R2 smoothing with variance s shifts the level towards the centre by (s + 1/6) (1/R1 + 1/R2) / 2, 1/6 the
///   mean of the interpolation's own share: a cylinder's 0.5 volume is off by (s + 1/6) / R^2, a ball's by 3 (s + 1/6) / R^2.
#pragma once

#include <array>

#include "core/base/geometry.h"
#include "core/drill/erosion.h"

namespace burrhole {

inline constexpr std::size_t kCoverageSamples = 64;

struct CoverageSamples {
  std::array<Vec3f, kCoverageSamples> offset;  ///< [voxels]
  double reach = 0.0;                          ///< [voxels] largest |coordinate| of any
  double variance = 0.0;                       ///< [voxels^2] of the kernel along an axis
};

[[nodiscard]] CoverageSamples make_coverage_samples(CoverageKernel kernel) noexcept;

}  // namespace burrhole
