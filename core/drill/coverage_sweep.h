/// core/drill/coverage_sweep.h: one sub-step of a tool as its cutting field sees it; inside of coverage.cpp.
///   Frames  index coordinates of the bone; nodes of the cutting field.   Units  as named.
#pragma once

#include <array>

#include "core/drill/coverage_samples.h"
#include "core/drill/field_sampler.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Interpolated distances may grow a little faster than the way [nodes].
inline constexpr double kSlackPitches = 0.25;
inline constexpr int kCoverageEdge = 8;  ///< [voxels] of a block of masks

struct CoverageSweep {
  CoverageSweep(const CuttingField& table, const CoverageSamples& samples, const Voxmap& voxmap, const ErosionPath& path);

  /// Whether a place that moves from q - half to q + half meets the tool. Strides of the distance itself pass nothing by.
  [[nodiscard]] bool met_on_the_way(const Vec3f& q, const Vec3f& half_step) const noexcept;
  /// [m] bound on the way, seen from the tool, of any place in the box or a block's edge beyond it.
  [[nodiscard]] double way_between(const CuttingField& table, const ErosionPath& path) const noexcept;

  using Places = std::array<float, kMostCoverageWords * kCoverageSamples>;
  FieldSampler field;
  VoxelBox box;                 ///< all that the tool can reach
  VoxelBox allowed;             ///< of it, what may be eroded
  Affine middle;                ///< nodes from index, in the middle of the sub-step
  Affine half;                  ///< from there to its end
  Places x{}, y{}, z{};         ///< [nodes] offsets of samples
  Places far{};                 ///< [m] of a sample from the centre
  std::array<Vec3f, 3> span{};  ///< [nodes] half the edges of the box that they fill
  Vec3f extent{0.0f};           ///< [nodes] largest |x|, |y|, |z|
  Vec3f end{0.0f};              ///< [nodes] last node of each axis
  double pitch = 0.0;           ///< [m] of a node
  double reach = 0.0;           ///< [m] largest of far
  double half_way = 0.0;        ///< [m] bound on half the way of any place in the box
  double ramp = 0.0;            ///< [m] w
  double cell = 0.0;            ///< [m] half the diagonal of a block
};

}  // namespace burrhole
