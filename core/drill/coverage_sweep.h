/// core/drill/coverage_sweep.h: one sub-step of a tool in the frame of its cutting field. Internal to coverage.cpp.
///   Frames  index coordinates of the bone; nodes of the cutting field.   Units  as each member states.   Errors  none.
#pragma once

#include <array>

#include "core/drill/coverage_samples.h"
#include "core/drill/field_sampler.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// [nodes] reserve for interpolated distances, which may grow slightly faster than the travel.
inline constexpr double kSlackPitches = 0.25;
inline constexpr int kCoverageEdge = 8;  ///< [voxels] edge of a block of masks

struct CoverageSweep {
  CoverageSweep(const CuttingField& table, const CoverageSamples& samples, const Voxmap& voxmap, const ErosionPath& path);

  /// @returns whether a point that moves from q - half_step to q + half_step meets the tool. Sphere tracing: a stride is at most the
  /// distance.
  [[nodiscard]] bool met_on_the_way(const Vec3f& q, const Vec3f& half_step) const noexcept;
  /// @returns a bound [m] on the travel, relative to the tool, of any point in the box or up to a block's edge outside it.
  [[nodiscard]] double way_between(const CuttingField& table, const ErosionPath& path) const noexcept;

  using Places = std::array<float, kMostCoverageWords * kCoverageSamples>;
  FieldSampler field;
  VoxelBox box;                 ///< all voxels that the tool can reach
  VoxelBox allowed;             ///< the part of `box` that may be eroded
  Affine middle;                ///< nodes from index, at the middle of the sub-step
  Affine half;                  ///< motion from the middle to the end of the sub-step
  Places x{}, y{}, z{};         ///< [nodes] offsets of samples
  Places far{};                 ///< [m] distances of the samples from the centre
  std::array<Vec3f, 3> span{};  ///< [nodes] half edges of the bounding box of the samples
  Vec3f extent{0.0f};           ///< [nodes] largest |x|, |y|, |z|
  Vec3f end{0.0f};              ///< [nodes] last node of each axis
  double pitch = 0.0;           ///< [m] spacing of nodes
  double reach = 0.0;           ///< [m] largest entry of `far`
  double half_way = 0.0;        ///< [m] bound on half the travel of any point in the box
  double ramp = 0.0;            ///< [m] w of coverage.h
  double cell = 0.0;            ///< [m] half the diagonal of a block
};

}  // namespace burrhole
