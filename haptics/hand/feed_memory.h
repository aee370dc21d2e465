/// haptics/hand/feed_memory.h: compares the recent feed of a drill, measured over distance, with its usual feed in the bone so far.
///   Frame  depth along the drill's axis.   Units SI.   Errors none.   Thread servo.   Source own work.
///   A window is a fixed distance of advance, its time the time that this advance took. Recent feed = window / time of the last window.
///   Usual feed = window / third quartile of the times of the earlier windows. Feed is inversely proportional to hardness, so this is the
///   feed in the hardest layer if at least a quarter of the windows lie in it. One stop of the drill lengthens the time of one window only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace burrhole {

/// The recent feed is computed four times per window, so a change of feed is noticed up to a quarter of a window late.
class FeedMemory {
 public:
  /// Forgets all.
  void clear() noexcept { *this = FeedMemory(); }
  /// Starts a new window and keeps the times of earlier ones: bone did not carry the thrust, so the present advance does not count.
  void skip() noexcept {
    known_ = false;
    parts_ = 0;
  }
  /// Advances one tick. Only new depth counts, so a hand that vibrates does not advance.
  /// @param depth [m]. @param window [m] > 0. @param dt [s] of the tick.
  /// @returns [-] recent feed over usual feed if a quarter of a window has just ended; 0 otherwise, and in the first window.
  double advance(double depth, double window, double dt) noexcept {
    if (!known_) {
      known_ = true;
      next_ = depth + window / kParts;
      time_ = 0.0;
    }
    time_ += dt;
    if (depth < next_) return 0.0;
    next_ += window / kParts;
    recent_[parts_ % kParts] = time_;
    time_ = 0.0;
    if (++parts_ < kParts) return 0.0;
    double time = 0.0;
    for (const double part : recent_) time += part;
    const double ratio = count_ > 0 ? times_[3 * count_ / 4] / time : 0.0;
    if (parts_ % kParts == 0 && count_ < kMost) keep(time);
    return ratio;
  }

 private:
  static constexpr std::size_t kParts = 4;
  static constexpr std::size_t kMost = 256;  // 38 mm at the smallest window of a hand

  void keep(double time) noexcept {
    const auto end = times_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto at = std::upper_bound(times_.begin(), end, time);
    std::move_backward(at, end, end + 1);
    *at = time;
    ++count_;
  }

  bool known_ = false;
  double next_ = 0.0, time_ = 0.0;  // [m] depth at which the present part ends, [s] since it began
  std::size_t parts_ = 0, count_ = 0;
  std::array<double, kParts> recent_{};  // [s] of the last parts
  std::array<double, kMost> times_{};    // [s] of each window, sorted
};

}  // namespace burrhole
