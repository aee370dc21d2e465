/// haptics/servo/force_limits.h: limits between a computed force and a hand, one class per limit. ServoStep::act() applies them in order.
///   Frame  any; the limits do not depend on it.   Units SI.   Thread servo, fixed memory.
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

/// @returns v scaled down to the length `longest` if it is longer. Correct also where the square of the length overflows.
[[nodiscard]] Vec3 shortened(const Vec3& v, double longest) noexcept BH_REALTIME;

/// [TellesONeill10] eq. (2), a bound on the change of force per tick, measured from the last *output* force: |F'_t - F'_(t-1)| <= delta.
/// The printed form starts from the last *requested* force F_(t-1). With it a jump passes in full one tick later (a step of A: delta, then
/// A), and the output lags by one tick, without bound on its slew, while the requested force changes faster than delta.
/// Apply a cap on magnitude before this limit: a step between two forces inside a ball stays inside it, so no windup occurs beyond the cap.
class SlewLimit {
 public:
  /// @param per_tick [N] delta; 0 or infinite: off.
  explicit SlewLimit(double per_tick) noexcept : per_tick_(per_tick) {}
  [[nodiscard]] Vec3 operator()(const Vec3& wanted) noexcept BH_REALTIME;
  [[nodiscard]] bool limited() const noexcept { return limited_; }  ///< in the last tick
  [[nodiscard]] double share() const noexcept { return share_; }    ///< [-] of the change that was wanted in the last tick; 1: all of it
  void clear() noexcept { shown_ = Vec3(0.0); }

 private:
  double per_tick_;
  Vec3 shown_{0.0};
  bool limited_ = false;
  double share_ = 1.0;
};

/// A gain that ramps linearly from 0 to 1 over the start time and back over the stop time; 0 s: immediately.
class SoftGain {
 public:
  SoftGain(double soft_start, double soft_stop, double dt) noexcept;
  /// Advances one tick towards 1 (on) or 0. @returns the gain of this tick.
  double operator()(bool on) noexcept BH_REALTIME;
  void cut() noexcept { gain_ = 0.0; }   ///< sets the gain to 0 immediately
  void open() noexcept { gain_ = 1.0; }  ///< sets the gain to 1 immediately
  [[nodiscard]] double gain() const noexcept { return gain_; }

 private:
  double rise_, fall_;  // per tick
  double gain_ = 0.0;
};

}  // namespace burrhole
