/// haptics/servo/energy_observer.h: measures the energy that the sampled wall generates, and computes the damping force that dissipates it.
///   Frame  any inertial frame, the same for forces and positions.   Units SI.   Thread servo, fixed memory.
///   A force held over a tick does the work  f(k-1) . (x(k) - x(k-1))  on the wall, exactly. f is the force of the device on the wall, the
///   negative of the commanded force. E_w is the sum of this work. The loop with the dissipation of device and hand is passive if E = E_w +
///   integral of b v^2 dt never falls below zero. A sampled spring alone always generates some energy, so E_w < 0 is not a fault by itself.
///   A reading that is d ticks old is paired with the force held d ticks before: the energy that a reading delay generates is measured too.
///   The usual form [HannafordRyu02], T sum f(k) v(k) with the backward difference, pairs the new force with the old motion. For a spring
///   it is a sum of K x_k (x_k - x_(k-1)) >= K x^2 / 2, which is never negative, so it detects nothing. The integral takes v as linear over
///   each tick.
///   While the held force is zero the wall is unloaded, and the balance restarts at each tick: energy dissipated in free motion is no
///   credit for the next contact, which may begin anywhere in the last tick. A passivity deficit (E < 0) is kept.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

inline constexpr int kMaxEnergyDelay = 31;  // [ticks]

struct EnergyObserverConfig {
  double damping = 0.0;    ///< [N s/m] >= 0: b, the guaranteed damping of device and hand together
  double tolerance = 0.0;  ///< [J] passivity deficit above which a fault is reported; 0: no detector
  double largest_damping =
      0.0;        ///< [N s/m] cap of the passivity controller; 0: none. Must be below 2 m / T, m the apparent mass, for stability
  int delay = 0;  ///< [ticks] 0..kMaxEnergyDelay, of the positions and velocities
};

class EnergyObserver {
 public:
  EnergyObserver(const EnergyObserverConfig& config, double dt) noexcept : config_(config), dt_(dt) {}
  /// Updates the balance at the start of a tick, before the new force. `held` [N] acted on the hand since the last tick.
  void operator()(const Vec3& position, const Vec3& velocity, const Vec3& held) noexcept BH_REALTIME;
  [[nodiscard]] double energy() const noexcept { return energy_; }  ///< [J] E; negative: deficit
  [[nodiscard]] bool fault() const noexcept { return config_.tolerance > 0.0 && energy_ < -config_.tolerance; }
  /// [HannafordRyu02] passivity controller: while E < 0 it adds a damping of -E / (T v^2), capped; v is the velocity of the last tick.
  /// @returns the force to add [N].
  [[nodiscard]] Vec3 damping_force() const noexcept BH_REALTIME;
  void clear() noexcept;
  /// Sets the hand to another place without work (after a jump). A passivity deficit is kept.
  void jump() noexcept { started_ = false; }

 private:
  EnergyObserverConfig config_;
  double dt_;
  bool started_ = false;
  Vec3 position_{0.0}, velocity_{0.0}, mean_velocity_{0.0};
  double energy_ = 0.0;
  std::array<Vec3, kMaxEnergyDelay + 1> held_{};  // ring of the last ticks
  std::size_t newest_ = 0;
};

}  // namespace burrhole
