/// core/base/step_timer.h: how long each call of a step took; figures for reports, never for a decision.
///   Units  microseconds.   Thread  one each.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstdint>
#include <vector>

namespace burrhole {

struct StepTiming {
  std::int64_t count = 0;                            ///< calls
  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0;  ///< [us] percentiles
  double max_us = 0.0, total_us = 0.0;               ///< [us]
};

/// Times a call and hands the duration [us] to `timer.add()`. @returns what the call returns.
template <class Timer, class F>
auto timed(Timer& timer, F&& f) {
  struct Stop {
    Timer& timer;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Stop() { timer.add(std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - start).count()); }
  } stop{timer};
  return f();
}

/// Keeps a histogram of fixed size, so it may run on a real-time thread for hours. Percentiles are the upper edge of their bin: at most
/// 1.6 % above the exact value. Count, largest and total are exact.
class StepTimer {
 public:
  template <class F>
  auto operator()(F&& f) {
    return timed(*this, std::forward<F>(f));
  }
  void add(float us) noexcept {
    ++bins_[bin_of(us)];
    ++count_;
    total_ += static_cast<double>(us);
    max_ = std::max(max_, static_cast<double>(us));
  }
  [[nodiscard]] StepTiming timing() const noexcept { return {count_, percentile(0.5), percentile(0.99), percentile(0.999), max_, total_}; }

 private:
  // Bins are equal shares of an octave of nanoseconds: 64 each, from 1 ns to 2^36 ns (69 s).
  static constexpr std::uint32_t kPerOctave = 64, kOctaves = 36;
  [[nodiscard]] static std::size_t bin_of(float us) noexcept {
    const float ns = std::clamp(us * 1e3f, 1.0f, 0x1p36f * 0.999f);
    // Exponent and the six leading bits of the mantissa of a float above 1.
    return (std::bit_cast<std::uint32_t>(ns) - std::bit_cast<std::uint32_t>(1.0f)) >> 17;
  }
  [[nodiscard]] double percentile(double share) const noexcept {
    if (count_ == 0) return 0.0;
    const auto rank = static_cast<std::int64_t>(share * static_cast<double>(count_ - 1)) + 1;
    std::int64_t below = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      below += bins_[bin];
      if (below < rank) continue;
      const auto edge = std::bit_cast<float>((static_cast<std::uint32_t>(bin + 1) << 17) + std::bit_cast<std::uint32_t>(1.0f));
      return std::min(max_, static_cast<double>(edge) * 1e-3);
    }
    return max_;
  }

  std::array<std::uint32_t, kPerOctave * kOctaves> bins_{};
  std::int64_t count_ = 0;
  double max_ = 0.0, total_ = 0.0;  // [us]
};

/// Keeps every sample: exact percentiles. Allocates.
class SampleTimer {
 public:
  template <class F>
  auto operator()(F&& f) {
    return timed(*this, std::forward<F>(f));
  }
  /// Adds the duration [us] of a call that was timed elsewhere.
  void add(float us) { samples_.push_back(us); }
  /// @returns the statistics of all calls; zeros if there are none.
  [[nodiscard]] StepTiming timing() const {
    StepTiming out;
    if (samples_.empty()) return out;
    std::vector<float> sorted = samples_;
    for (const float sample : sorted) out.total_us += static_cast<double>(sample);
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
      return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
    };
    out.count = static_cast<std::int64_t>(sorted.size());
    out.p50_us = at(0.5);
    out.p99_us = at(0.99);
    out.p999_us = at(0.999);
    out.max_us = at(1.0);
    return out;
  }

 private:
  std::vector<float> samples_;
};

}  // namespace burrhole
