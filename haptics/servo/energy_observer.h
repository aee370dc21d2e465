/// haptics/servo/energy_observer.h: has the sampled wall given the hand energy that nobody put in, and who pays for it.
///   Units SI.   Thread servo, fixed memory.
///   A force held over a tick does work on the wall of exactly  f(k-1) . (x(k) - x(k-1)),  f what the device exerts on the wall, minus the
///   force commanded. Passive together with what device and hand swallow, E = E_w + integral of b v^2 dt never falls below zero; a sampled
///   spring alone always leaks a little, so E_w < 0 is no fault by itself. The observer as usually printed [HannafordRyu02], T sum f(k)
///   v(k) with the backward difference, pairs the new force with the old motion: for a spring it is a sum of K x_k (x_k - x_(k-1)) >= K x^2
///   / 2 and sees nothing. The integral takes v as a straight line over each tick. While nothing is held the wall is unloaded and the
///   account starts anew with each tick: what was swallowed in free motion is no credit for the next contact, which may begin anywhere in
///   the last tick; what is owed stays owed.
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

struct EnergyObserverConfig {
  double damping = 0.0;    ///< [N s/m] >= 0: b of device and hand together, that may be relied upon
  double tolerance = 0.0;  ///< [J] that may be owed before it is a fault; 0: no detector
  double largest_damping =
      0.0;  ///< [N s/m] cap of the passivity controller; 0: none. Below 2 m / T, m the mass felt, or it drives by itself
};

class EnergyObserver {
 public:
  EnergyObserver(const EnergyObserverConfig& config, double dt) noexcept : config_(config), dt_(dt) {}
  /// The hand at the start of a tick, before the new force; `held` [N] is what was on it since the tick before.
  void operator()(const Vec3& position, const Vec3& velocity, const Vec3& held) noexcept BH_REALTIME;
  [[nodiscard]] double energy() const noexcept { return energy_; }  ///< [J] E; negative: owed
  [[nodiscard]] bool fault() const noexcept { return config_.tolerance > 0.0 && energy_ < -config_.tolerance; }
  /// [HannafordRyu02] passivity controller: while energy is owed, a damping of -E / (T v^2), capped, v the last tick's. @returns force [N]
  /// to add.
  [[nodiscard]] Vec3 repay() const noexcept BH_REALTIME;
  void clear() noexcept;
  /// The hand was put elsewhere: its way there is no motion and does no work. What is owed stays owed.
  void jump() noexcept { started_ = false; }

 private:
  EnergyObserverConfig config_;
  double dt_;
  bool started_ = false;
  Vec3 position_{0.0}, velocity_{0.0}, mean_velocity_{0.0};
  double energy_ = 0.0;
};

}  // namespace burrhole
