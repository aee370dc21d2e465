/// volumes/read/resample.h: values of a scan at the voxels of another grid, by cubic convolution of its refined slices, layer by layer.
///   Frame   index of the grid; scan_from_grid maps it to the index of the scan.   Units that of the scan.   Errors none.
///   Thread  one; it uses all cores.
///   Source  cubic_kernel.h; along the rows and across the rows of a slice the sum is limited to the range of its samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "volumes/read/cubic_kernel.h"
#include "volumes/read/quiet_values.h"
#include "volumes/read/refine_slices.h"
#include "volumes/read/scan.h"

namespace burrhole {

struct ResampleRule {
  RefineRule slices;       ///< between those of the scan
  float nothing = 0.0f;    ///< [HU] or [unit of the scan] outside the scan's voxels; in the outer halves of those at its border, theirs
  double middle = -1e30;   ///< [unit of the scan] of the band of bone
  double half_band = 0.0;  ///< [unit of the scan]
};

/// @returns the bytes of a Resampler beside the layers of a slab: with axes that are not parallel, all refined slices.
[[nodiscard]] std::uint64_t resampler_bytes(const Scan& scan, int factor, const Affine& scan_from_grid) noexcept;

/// If both grids have parallel axes, each axis is interpolated by itself; otherwise the 216 voxels around each place are read. Both give
/// the same bits where both apply.
class Resampler {
 public:
  /// @param dims of the grid. @pre `scan` outlives this object.
  Resampler(const Scan& scan, const ResampleRule& rule, const Affine& scan_from_grid, const Vec3i& dims);

  /// Computes the values of the layers k_lo - 1 to k_hi, with a margin of one voxel on the other axes too: out holds
  /// (dims.x + 2) (dims.y + 2) (k_hi - k_lo + 2) values, i fastest. NaN: not computed, as there and in the next voxels occupancy is 0.
  void fill(int k_lo, int k_hi, std::span<float> out);

 private:
  /// One axis of the grid with its margin of a voxel at either end.
  struct Axis {
    std::vector<CubicAxis> at;
    std::vector<std::uint8_t> outside;
  };
  /// A refined slice on the other two axes of the grid.
  struct Layer {
    int index = -1;
    std::vector<float> values;
  };
  [[nodiscard]] Axis axis_of(std::size_t axis, std::ptrdiff_t stride) const;
  void prepare_any_axes();
  [[nodiscard]] std::span<const float> values() const noexcept { return all_.empty() ? std::span<const float>(scan_->values) : all_; }
  [[nodiscard]] float value_at(const Vec3& scan_index) const;
  void fill_each(int k_lo, int layers, std::span<float> out) const;
  void fill_aligned(int k_lo, int layers, std::span<float> out);
  void make_layer(int index, Layer& layer);
  [[nodiscard]] const Layer& layer_of(int index) const;

  RefinedSlices slices_;
  const Scan* scan_;
  Affine scan_from_grid_;
  Vec3i padded_;  // of the grid with its margins; z unused
  ResampleRule rule_;
  bool aligned_;
  Axis x_, y_, z_;
  std::vector<Layer> layers_;
  std::optional<QuietValues> quiet_;  // for any axes
  std::vector<float> all_;            // refined slices for any axes, if there are more than those of the scan
};

}  // namespace burrhole
