/// core/drill/coverage_samples.h: 64 or 256 places in and round a voxel that stand for it when its coverage by a tool is measured.
///   Frame  index coordinates, relative to the voxel's centre.   Source  own derivation:
///   Coverage is the share of the samples inside the tool: the tool's solid, averaged over a kernel. Along each axis the N samples have N
///   distinct levels of equal weight, so that an axis-aligned wall moves in steps of 1/N. Which level of y and z goes with which of x: of
///   64 found by simulated annealing of the largest error over half-spaces of any tilt and over small balls on the grid of voxels; of 256
///   by search among lattices of rank 1.
///   The volume of a tool at rest is the count of all voxels' samples in it over N. Worst of 400 positions and turns, of a ball and a
///   cylinder of radius r voxels, as high as wide:  r = 1: 6.0 and 4.0 % of 64, 2.0 and 1.7 % of 256;  r = 1.5: 2.7 and 2.3 %, 0.8 and 0.8
///   %; r = 2: 1.4 and 1.2 %, 0.6 and 0.5 %. So tools slimmer than two voxels are given 256.
///   Kernels along an axis, all of which add up to 1 over the voxels (removed mass is the swept volume), and what a 0.5 level, read by
///   linear interpolation, makes of a level wall, whose offset from the voxel's centre is t:
///     cell       1 on +-1/2: off by up to 0.086 voxel (t = 0.25 and 0.75); the sharpest, variance 1/12.
///     trapezoid  3/4 on +-1/2, 1/4 on to +-1, between the two others: off by up to 0.05 voxel; variance 5/24.
///     wide       1/2 on +-1: exact, as in volumes/phantom/phantom.h; variance 1/3.
///   On a surface with radii R1 and R2 smoothing with variance s shifts the level towards the centre by (s + 1/6) (1/R1 + 1/R2) / 2, 1/6
///   the mean of the interpolation's own share: a cylinder's 0.5 volume is off by (s + 1/6) / R^2, a ball's by 3 (s + 1/6) / R^2.
#pragma once

#include <array>

#include "core/base/geometry.h"
#include "core/drill/erosion.h"

namespace burrhole {

inline constexpr std::size_t kCoverageSamples = 64;   ///< that one word of a mask tells of
inline constexpr std::size_t kMostCoverageWords = 4;  ///< of a mask

/// Places of the first words * kCoverageSamples.
struct CoverageSamples {
  std::array<Vec3f, kMostCoverageWords * kCoverageSamples> offset{};  ///< [voxels]
  std::size_t words = 1;                                              ///< 1 or kMostCoverageWords
  double reach = 0.0;                                                 ///< [voxels] largest |coordinate| of any
  double variance = 0.0;                                              ///< [voxels^2] of the kernel along an axis
  [[nodiscard]] std::size_t size() const noexcept { return words * kCoverageSamples; }
};

/// Words that a tool needs whose cutting part is nowhere narrower than that to each side [voxels].
[[nodiscard]] std::size_t coverage_words(double least_half_width) noexcept;

/// @pre words is 1 or kMostCoverageWords.
[[nodiscard]] CoverageSamples make_coverage_samples(CoverageKernel kernel, std::size_t words) noexcept;

}  // namespace burrhole
