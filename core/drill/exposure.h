/// core/drill/exposure.h: sum of the weights of the erosion points in each voxel, exact for every point.
///   Frame   index coordinates of the bone.   Units  of the weights.   Errors  none.   Thread  simulation.
///   Exact   A point's position is rounded to 2^-32 voxel (at most twice), weights to 2^-38 of the largest. All sums are integers, so the
///           result does not depend on the order of the points or the SIMD level. Own derivation, shown in exposure.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/geometry.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Sums over a box that contains the points of the tool. Rows start at a multiple of 8 voxels from the window's corner and have a multiple
/// of 8 voxels, so they may extend beyond the window; sums there are zero.
struct ExposureField {
  VoxelBox box;
  std::vector<std::int64_t> sums;  ///< dense over box, i fastest; the consumer of a value resets it to zero
  double unit = 1.0;               ///< [unit of the weights] exposure = sum x unit
  [[nodiscard]] double at(const Vec3i& v) const noexcept {
    return box.contains(v) ? static_cast<double>(sums[box.offset_of(v)]) * unit : 0.0;
  }
  /// Sets `box` to a part of `allowed` of the window, with all sums zero. @pre all sums are zero.
  void place(const MasterWindow& window, const VoxelBox& part);
};

/// The points of a tool in lattice order, as runs along the tool's x axis.
class PointScatter {
 public:
  PointScatter() = default;
  /// @pre points are finite, factors finite and >= 0 (Erosion::create checks). Any order; points on no lattice are runs of length one.
  explicit PointScatter(const ErosionPoints& points);

  [[nodiscard]] std::span<const float> distinct_factors() const noexcept { return distinct_; }
  /// Sets the weight of each point by its factor, in the order of distinct_factors(). @pre finite, >= 0.
  void set_weights(std::span<const double> weights);

  /// Places `field` around the points at a pose and adds the weight of each point to the voxel that contains it.
  /// @returns the number of points outside the erodible box of the window; they add nothing.
  std::uint32_t add(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field);
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  void measure_steps(const Vec3& along, const Vec3i& strides);
  std::uint32_t add_cut_run(std::size_t run, const Affine& index_from_window, const VoxelBox& allowed, ExposureField& field,
                            const Vec3i& corner);
  [[nodiscard]] std::uint64_t weight_before(std::uint32_t point) const noexcept;

  double pitch_ = 0.0;
  std::uint32_t count_ = 0;
  Bounds tool_bounds_;                         // of the points, tool frame
  std::vector<double> run_x_, run_y_, run_z_;  // [m] first point of each run, tool frame; padded to whole vectors
  std::vector<double> run_span_;               // points in the run minus one
  std::vector<std::uint32_t> run_first_;       // plus one entry: the end of the last run
  std::uint32_t longest_ = 0;                  // longest run [points]
  std::vector<float> distinct_;                // sorted
  std::vector<std::uint32_t> kind_;            // of each point: index into distinct_; empty if there is one factor only
  std::vector<std::uint64_t> before_;          // sum of the weights of all previous points (modulo 2^64); empty if all weights are equal
  std::uint64_t weight_ = 0;                   // of every point, if all weights are equal
  double unit_ = 1.0;
  // Of the current pose: steps along a run (whole voxels as an offset, fractions) and starts of runs.
  std::vector<std::int32_t> step_offset_, step_x_, step_y_, step_z_;
  std::vector<std::int32_t> base_, carry_x_, carry_y_, carry_z_, inside_;
};

}  // namespace burrhole
