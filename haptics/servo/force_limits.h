/// haptics/servo/force_limits.h: what stands between a computed force and a hand, each limit a small thing of its own; ServoStep::act()
///   puts them in order.
///   Units SI.   Thread servo, fixed memory.
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

/// v, no longer than `longest`, in its own direction; also where the square of its length overflows.
[[nodiscard]] Vec3 shortened(const Vec3& v, double longest) noexcept BH_REALTIME;

/// [TellesONeill10] eq. (2), a bound on the change of force a tick, measured from the force *shown* before: |F'_t - F'_(t-1)| <= delta. As
/// printed it starts from F_(t-1), the force asked for before; then a jump passes whole one tick later (a step of A: delta, then A), and
/// while the force asked for changes faster than delta the shown one follows it a tick late at any speed.
/// A cap on magnitude belongs before it: between two forces inside a ball every step stays inside, and nothing winds up beyond it.
class SlewLimit {
 public:
  /// @param per_tick [N] delta; 0 or infinite: off.
  explicit SlewLimit(double per_tick) noexcept : per_tick_(per_tick) {}
  [[nodiscard]] Vec3 operator()(const Vec3& wanted) noexcept BH_REALTIME;
  [[nodiscard]] bool limited() const noexcept { return limited_; }  ///< in the last tick
  void clear() noexcept { shown_ = Vec3(0.0); }

 private:
  double per_tick_;
  Vec3 shown_{0.0};
  bool limited_ = false;
};

/// A gain that goes from 0 to 1 over the start's time and back over the stop's, in a straight line; 0 s: at once.
class SoftGain {
 public:
  SoftGain(double soft_start, double soft_stop, double dt) noexcept;
  /// One tick towards 1 (on) or 0. @returns the gain of this tick.
  double operator()(bool on) noexcept BH_REALTIME;
  void cut() noexcept { gain_ = 0.0; }   ///< to zero at once
  void open() noexcept { gain_ = 1.0; }  ///< to the whole at once
  [[nodiscard]] double gain() const noexcept { return gain_; }

 private:
  double rise_, fall_;  // a tick
  double gain_ = 0.0;
};

}  // namespace burrhole
