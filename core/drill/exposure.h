/// core/drill/exposure.h: how much of a tool's erosion points lies in each voxel: the exact sum of their weights, point by point.
///   Frame   index coordinates of the bone.   Units  weights as the caller gives them.   Thread  simulation.
///   Exact   A point's position is rounded to 2^-32 voxel (twice at most), weights to 2^-38 of the largest; all sums are whole numbers,
///           so that neither the order of the points nor the SIMD level matters. Own derivation, shown in exposure.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Sums over a box that the tool's points lie in: rows start at a multiple of 8 voxels from the window's corner and are a multiple of 8
/// long, so that they may reach past the window; what lies there is zero.
struct ExposureField {
  VoxelBox box;
  std::vector<std::int64_t> sums;  ///< dense over box, i fastest; whoever reads a value for good puts it back to zero
  double unit = 1.0;               ///< exposure = sum x unit
  [[nodiscard]] double at(const Vec3i& v) const noexcept {
    return box.contains(v) ? static_cast<double>(sums[box.offset_of(v)]) * unit : 0.0;
  }
  /// Takes over a part of `allowed` of that window, with all sums zero. Requires all sums zero before.
  void place(const MasterWindow& window, const VoxelBox& part);
};

/// A tool's points in the order of its lattice, as runs along the tool's x.
class PointScatter {
 public:
  PointScatter() = default;
  /// Points finite, factors finite and at least 0 (Erosion::create checks); any order, points on no lattice are runs of one.
  explicit PointScatter(const ErosionPoints& points);

  [[nodiscard]] std::span<const float> distinct_factors() const noexcept { return distinct_; }
  /// Weight of each point by its factor, in the order of distinct_factors(); finite, at least 0.
  void set_weights(std::span<const double> weights);

  /// Places `field` round the points at that pose and adds the weight of each to the voxel that holds it.
  /// @returns points outside the window's erodible box: they add nothing.
  std::uint32_t add(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field);

 private:
  void measure_steps(const Vec3& along, const Vec3i& strides);
  std::uint32_t add_cut_run(std::size_t run, const Affine& index_from_window, const VoxelBox& allowed, ExposureField& field,
                            const Vec3i& corner);
  [[nodiscard]] std::uint64_t weight_before(std::uint32_t point) const noexcept;

  double pitch_ = 0.0;
  std::uint32_t count_ = 0;
  Vec3 lo_{0.0}, hi_{0.0};                     // bounds of the points, tool frame
  std::vector<double> run_x_, run_y_, run_z_;  // [m] first point of each run, tool frame; padded to whole vectors
  std::vector<double> run_span_;               // points in the run, less one
  std::vector<std::uint32_t> run_first_;       // and one more: the end of the last
  std::uint32_t longest_ = 0;                  // run
  std::vector<float> distinct_;                // sorted
  std::vector<std::uint32_t> kind_;            // of each point: into distinct_; empty where there is but one
  std::vector<std::uint64_t> before_;          // sum of the weights of all points before (modulo 2^64); empty where all weigh the same
  std::uint64_t weight_ = 0;                   // of every point, where all weigh the same
  double unit_ = 1.0;
  // Of the pose at hand: steps along a run (whole voxels as an offset, fractions) and where runs start.
  std::vector<std::int32_t> step_offset_, step_x_, step_y_, step_z_;
  std::vector<std::int32_t> base_, carry_x_, carry_y_, carry_z_, inside_;
};

}  // namespace burrhole
