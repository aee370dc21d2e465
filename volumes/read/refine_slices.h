/// volumes/read/refine_slices.h: slices between those of a scan, interpolated along the surfaces of bone rather than across the slices.
///   Frame   index of the scan; refined slice n lies at n / factor slices.   Units that of the scan; shifts in pixels per slice.
///   Errors  none.   Thread one; it uses all cores.   Bits do not depend on the number of threads.
///   Method  A surface that is oblique to the slices is displaced from each slice to the next. Interpolation across the slices mixes its two
///           sides, and the surface gets a terrace per slice. Here the samples are displaced with the surface: by s pixels per slice,
///           s = -g_z g_xy / (|g_xy|^2 + g_z^2 / S^2 + e^2), g the gradient of the values (of at least `low`) smoothed by a Gaussian whose
///           standard deviation is the distance of the slices. Without S and e that is the shortest displacement along which the values do
///           not change; S limits it to S / 2 slice distances where the surface lies in the slice, e to zero where the values are flat.
///           As registration-based interpolation of slices [Penney04], with a gradient in place of a registration.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "volumes/read/scan.h"

namespace burrhole {

struct RefineRule {
  int factor = 1;     ///< slices per slice of the scan, >= 1; 1: the slices of the scan
  double low = 0.0;   ///< [unit of the scan] values below, as those of air, count as this one in the gradient
  double flat = 0.0;  ///< [unit of the scan / m] e above
};

/// @returns how many slices per slice of the scan make their distance about that of the pixels, at most 8, and no more than a grid of cubes of
/// `pitch` [m] needs; 1 if the slices are less than 1.5 pixels apart.
[[nodiscard]] int slice_factor(const Scan& scan, double pitch) noexcept;

class RefinedSlices {
 public:
  /// @pre `scan` outlives this object.
  RefinedSlices(const Scan& scan, const RefineRule& rule);

  [[nodiscard]] const Scan& scan() const noexcept { return *scan_; }
  [[nodiscard]] int factor() const noexcept { return rule_.factor; }
  [[nodiscard]] int count() const noexcept { return (scan_->dims.z - 1) * rule_.factor + 1; }
  /// @returns the pixels of refined slice n, i fastest; valid until the next call. In rising order each displacement is computed once.
  [[nodiscard]] std::span<const float> slice(int n);

 private:
  /// One axis of the Gaussian: weights of a sum, and of a difference that is exact for a line.
  struct Taps {
    std::vector<float> smooth, slope;
  };
  [[nodiscard]] static Taps make_taps(double first, std::size_t count, double sigma);
  [[nodiscard]] const float* row(int j, int k) const noexcept;
  void find_shifts(int k);
  void smooth_across(int k, const Taps& z, int j);
  void finish_shifts(int j);
  void interpolate_row(int k, double t, int j);

  const Scan* scan_;
  RefineRule rule_;
  Vec3 spacing_;
  Taps x_, y_;
  int interval_ = -1;                         // of shift_: between this slice and the next
  std::vector<float> smooth_, slope_, rise_;  // of the interval, smoothed along z and x
  std::vector<float> shift_x_, shift_y_, out_;
};

/// @returns the bytes that a RefinedSlices of this scan takes.
[[nodiscard]] std::size_t refined_bytes(const Scan& scan, int factor) noexcept;

}  // namespace burrhole
