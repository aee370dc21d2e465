/// volumes/read/cubic_kernel.h: weights of cubic convolution over six samples.
///   Units samples.   Errors none.   Thread any.
///   Source  [Keys81], the kernel over six samples: interpolating, exact for cubics. Written in factors, so that the weights at a sample are
///           exactly 0 and 1. An edge between two samples overshoots by 9.3 %; the sum of all |weights| is at most 1.375.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace burrhole {

inline constexpr std::size_t kCubicTaps = 6;

/// @param t fraction 0..1 between the third and the fourth sample.
[[nodiscard]] inline std::array<float, kCubicTaps> cubic_weights(double t) noexcept {
  const double u = 1.0 - t;
  return {static_cast<float>(t * u * u / 12.0),
          static_cast<float>(-t * u * (8.0 - 7.0 * t) / 12.0),
          static_cast<float>(u * (1.0 + t - 4.0 / 3.0 * t * t)),
          static_cast<float>(t * (1.0 + u - 4.0 / 3.0 * u * u)),
          static_cast<float>(-t * u * (8.0 - 7.0 * u) / 12.0),
          static_cast<float>(u * t * t / 12.0)};
}

/// Cubic convolution on one axis at one place.
struct CubicAxis {
  std::array<std::ptrdiff_t, kCubicTaps> offset;  ///< [elements] of the six samples, times the stride
  std::array<float, kCubicTaps> weight;           ///< [-]
  /// @param at [samples] on the axis; clamped to the samples, and so are the six.
  CubicAxis(double at, int size, std::ptrdiff_t stride) noexcept {
    const double p = std::clamp(at, 0.0, static_cast<double>(size - 1));
    const int base = std::min(static_cast<int>(p), std::max(size - 2, 0));
    weight = cubic_weights(p - base);
    for (std::size_t n = 0; n < kCubicTaps; ++n) offset[n] = stride * std::clamp(base + static_cast<int>(n) - 2, 0, size - 1);
  }
};

/// Weighted sum of six samples, limited to their range: beside an edge there is no overshoot. @param at at(n) is sample n.
template <class At>
[[nodiscard]] inline float limited_sum(const std::array<float, kCubicTaps>& weight, At&& at) noexcept {
  float sum = 0.0f, least = at(0), most = least;
  for (std::size_t n = 0; n < kCubicTaps; ++n) {
    const float value = at(n);
    sum += weight[n] * value;
    least = value < least ? value : least;
    most = value > most ? value : most;
  }
  sum = sum < least ? least : sum;
  return sum > most ? most : sum;
}

/// The same of `kLanes` sums side by side. @param samples six rows of kLanes floats.
template <std::size_t kLanes>
inline void limited_sums(const std::array<float, kCubicTaps>& weight, const float* samples, float* out) noexcept {
  std::array<float, kLanes> sum{}, least, most;
  for (std::size_t l = 0; l < kLanes; ++l) least[l] = most[l] = samples[l];
  for (std::size_t n = 0; n < kCubicTaps; ++n)
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float value = samples[n * kLanes + l];
      sum[l] += weight[n] * value;
      least[l] = value < least[l] ? value : least[l];
      most[l] = value > most[l] ? value : most[l];
    }
  for (std::size_t l = 0; l < kLanes; ++l) {
    const float raised = sum[l] < least[l] ? least[l] : sum[l];
    out[l] = raised > most[l] ? most[l] : raised;
  }
}

}  // namespace burrhole
