/// volumes/read/resample.h: values of a scan at the voxels of another grid, by cubic interpolation, layer by layer.
///   Frame   index of the grid; scan_from_grid maps it to the index of the scan.   Units that of the scan.   Errors none.
///   Thread  one; it uses all cores.
///   Source  Catmull & Rom 1974: weights of the four voxels around a fraction t; interpolating, exact for quadratics. At an edge as wide as a
///           slice it moves the surface by up to 0.12 slices; linear interpolation moves it by up to 0.16 slices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// Cubic interpolation on one axis at one place.
struct CubicAxis {
  std::array<std::ptrdiff_t, 4> offset;  ///< [elements] of the four voxels, times the stride
  std::array<double, 4> weight;          ///< [-]
  /// @param at [voxels] on the axis; clamped to the voxels of the scan.
  CubicAxis(double at, int size, std::ptrdiff_t stride);
};

/// If both grids have parallel axes, each axis is interpolated by itself; otherwise the 64 voxels around each place are read. Both give the
/// same bits where both apply.
class Resampler {
 public:
  /// @param dims of the grid. @param nothing value outside the outer faces of the scan's voxels; in their outer halves the value is that of
  /// the border. @pre `scan` outlives this object.
  Resampler(const Scan& scan, const Affine& scan_from_grid, const Vec3i& dims, float nothing);

  /// Computes the values of the layers k_lo - 1 to k_hi, with a margin of one voxel on the other axes too: out holds
  /// (dims.x + 2) (dims.y + 2) (k_hi - k_lo + 2) values, i fastest.
  void fill(int k_lo, int k_hi, std::span<float> out);

 private:
  /// One axis of the grid with its margin of a voxel at either end.
  struct Axis {
    std::vector<CubicAxis> at;
    std::vector<std::uint8_t> outside;
  };
  /// A layer of the scan on the other two axes of the grid.
  struct Layer {
    int index = -1;
    std::vector<double> values;
  };
  [[nodiscard]] Axis axis_of(std::size_t axis, std::ptrdiff_t stride) const;
  [[nodiscard]] float value_at(const Vec3& scan_index) const;
  void fill_each(int k_lo, int layers, std::span<float> out) const;
  void fill_aligned(int k_lo, int layers, std::span<float> out);
  void make_layer(int index, Layer& layer) const;
  [[nodiscard]] const Layer& layer_of(int index) const;

  const Scan* scan_;
  Affine scan_from_grid_;
  Vec3i padded_;  // of the grid with its margins; z unused
  float nothing_;
  bool aligned_;
  Axis x_, y_, z_;
  std::vector<Layer> layers_;
};

}  // namespace burrhole
