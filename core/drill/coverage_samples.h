/// core/drill/coverage_samples.h: 64 or 256 sample points in and around a voxel, for the measurement of its coverage by a tool.
///   Frame  index coordinates, relative to the voxel's centre.   Units  voxels.   Errors  none.   Source  own derivation:
///   Coverage is the share of the samples inside the tool: the solid of the tool, averaged with a kernel. Along each axis the N samples
///   have N distinct levels of equal weight, so an axis-aligned wall moves in steps of 1/N. The levels of y and z assigned to each level of
///   x were found, for 64 samples, by simulated annealing of the largest error over half-spaces of any tilt and small balls on the voxel
///   grid; for 256 samples, by a search among rank-1 lattices.
///   The volume of a tool at rest is the number of samples in it, over N. Largest error over 400 positions and orientations, for a ball and
///   a cylinder of radius r voxels and height 2 r:   r = 1: 6.0 and 4.0 % with 64, 2.0 and 1.7 % with 256;   r = 1.5: 2.7 and 2.3 %, 0.8
///   and 0.8 %;   r = 2: 1.4 and 1.2 %, 0.6 and 0.5 %. Tools slimmer than two voxels therefore use 256 samples.
///   Kernels along an axis. Each sums to 1 over the voxels, so the removed mass is the swept volume. They differ in the position of the 0.5
///   level, read by linear interpolation, of a level wall whose offset from the voxel's centre is t:
///     cell       1 on +-1/2: error up to 0.086 voxel (t = 0.25 and 0.75); the sharpest, variance 1/12.
///     trapezoid  3/4 on +-1/2, 1/4 up to +-1, between the two others: error up to 0.05 voxel; variance 5/24.
///     wide       1/2 on +-1: exact, as in volumes/phantom/phantom.h; variance 1/3.
///   On a surface with radii R1 and R2, smoothing with variance s shifts the level towards the centre by (s + 1/6) (1/R1 + 1/R2) / 2, where
///   1/6 is the mean effect of interpolation. The relative error of the 0.5 volume is (s + 1/6) / R^2 for a cylinder, 3 (s + 1/6) / R^2
///   for a ball.
#pragma once

#include <array>

#include "core/base/geometry.h"
#include "core/drill/erosion.h"

namespace burrhole {

inline constexpr std::size_t kCoverageSamples = 64;   ///< per word of a mask
inline constexpr std::size_t kMostCoverageWords = 4;  ///< words of the largest mask

/// Sample points: the first words * kCoverageSamples entries are used.
struct CoverageSamples {
  std::array<Vec3f, kMostCoverageWords * kCoverageSamples> offset{};  ///< [voxels]
  std::size_t words = 1;                                              ///< 1 or kMostCoverageWords
  double reach = 0.0;                                                 ///< [voxels] largest |coordinate| of any sample
  double variance = 0.0;                                              ///< [voxels^2] of the kernel along an axis
  [[nodiscard]] std::size_t size() const noexcept { return words * kCoverageSamples; }
};

/// @returns the words that a tool needs. @param least_half_width [voxels] smallest half-width of its cutting part.
[[nodiscard]] std::size_t coverage_words(double least_half_width) noexcept;

/// @pre words is 1 or kMostCoverageWords.
[[nodiscard]] CoverageSamples make_coverage_samples(CoverageKernel kernel, std::size_t words) noexcept;

}  // namespace burrhole
