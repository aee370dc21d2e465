/// app/engine/step_timer.h: how long each call of a step took; figures for the summary, never for a decision.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

namespace burrhole {

struct StepTiming {
  std::int64_t count = 0;
  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0, total_us = 0.0;
};

class StepTimer {
 public:
  template <class F>
  auto operator()(F&& f) {
    struct Stop {
      StepTimer& timer;
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Stop() { timer.samples_.push_back(std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - start).count()); }
    } stop{*this};
    return f();
  }
  /// A call that was timed elsewhere.
  void add(float us) { samples_.push_back(us); }
  /// @param skip so many calls at the start are left out.
  [[nodiscard]] StepTiming timing(std::size_t skip = 0) const {
    StepTiming out;
    if (samples_.size() <= skip) return out;
    const std::vector<float> taken(samples_.begin() + static_cast<std::ptrdiff_t>(skip), samples_.end());
    std::vector<float> sorted = taken;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
      return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
    };
    out.count = static_cast<std::int64_t>(sorted.size());
    out.p50_us = at(0.5);
    out.p99_us = at(0.99);
    out.p999_us = at(0.999);
    out.max_us = at(1.0);
    for (const float sample : taken) out.total_us += static_cast<double>(sample);
    return out;
  }

 private:
  std::vector<float> samples_;
};

}  // namespace burrhole
