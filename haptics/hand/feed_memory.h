/// haptics/hand/feed_memory.h: the feed of a drill over distance: the recent one against the usual one in the bone so far.
///   Frame  depth along the drill's axis.   Units SI.   Errors none.   Thread servo.   Source own work.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace burrhole {

/// Distance is counted in windows. The time of a window is measured four times per window, so an advance is noticed a quarter of it late.
class FeedMemory {
 public:
  /// Forgets all.
  void clear() noexcept { *this = FeedMemory(); }
  /// Forgets the advance of the present window: the drill was not held by bone.
  void skip() noexcept {
    known_ = false;
    parts_ = 0;
  }
  /// Advances one tick. Only the deepest depth so far counts: a hand that vibrates does not advance.
  /// @param depth [m]. @param window [m] > 0. @param dt [s].
  /// @returns recent feed over usual feed if a quarter of a window has just ended, otherwise 0. The usual feed is that of the slowest
  /// quarter of all windows before the recent one: feed in the densest layer, where a stop of the drill does not count for long.
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
