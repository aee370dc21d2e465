/// core/drill/spindle.h: a spindle that slows under load. Made only where a scene asks for it (std::optional<SpindleConfig>); without one
///   the spin is what is commanded.
///   Units SI; speeds in rev/s.   Source  own derivation from the straight line of a dc motor:
///   motor torque M_m(n) = M_stall (1 - n / n0);  2 pi I dn/dt = M_m(n) - M, M the cutting torque (cutting_torque in energy.h).
///   Steady: n = n0 (1 - M / M_stall), 0 from M_stall on. On the way there dn/dt = (n_steady - n) / tau, tau = 2 pi I n0 / M_stall, with
///   n_steady as the line has it, below 0 too: n(t) = n_steady + (n(0) - n_steady) exp(-t / tau), exact for any step. Cutting resists and
///   never drives: at 0 the spindle stays, until the load falls below M_stall.
#pragma once

#include "core/base/result.h"

namespace burrhole {

struct SpindleConfig {
  double free_speed = 1000.0 / 60.0;  ///< [rev/s] > 0: n0, without load
  double stall_torque = 2.0;          ///< [N m] > 0: M_stall (an assumption)
  double inertia = 1e-4;              ///< [kg m^2] >= 0: I of all that turns, seen at the bit (an assumption); 0: no lag
};

class Spindle {
 public:
  /// out_of_range when a number of the config is outside its range. Starts at the free speed.
  [[nodiscard]] static Result<Spindle> create(const SpindleConfig& config);

  /// Advances by `dt` [s] >= 0 under a torque [N m] >= 0 that is constant meanwhile. @returns the speed at the end [rev/s], never below 0.
  double step(double torque, double dt) noexcept;

  [[nodiscard]] double speed() const noexcept { return speed_; }                 ///< [rev/s]
  [[nodiscard]] double time_constant() const noexcept { return lag_; }           ///< [s] tau
  [[nodiscard]] double steady_speed(double torque) const noexcept;               ///< [rev/s] where it settles under that torque, >= 0
  void set_speed(double speed) noexcept { speed_ = speed > 0.0 ? speed : 0.0; }  ///< [rev/s] a motor switched off starts from 0

 private:
  explicit Spindle(const SpindleConfig& config);
  SpindleConfig config_;
  double lag_;
  double speed_;
};

}  // namespace burrhole
