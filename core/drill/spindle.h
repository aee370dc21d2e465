/// core/drill/spindle.h: a spindle that slows down under load. Made only if the scene requests it (std::optional<SpindleConfig>); otherwise
///   the spin is the commanded one.
///   Units  SI; speeds in rev/s.   Errors  out_of_range from create().   Thread  simulation.
///   Source  own derivation from the linear torque-speed curve of a dc motor:
///   motor torque M_m(n) = M_stall (1 - n / n0);  2 pi I dn/dt = M_m(n) - M, M the cutting torque (cutting_torque in energy.h).
///   Steady state: n = n0 (1 - M / M_stall), 0 for M >= M_stall. Transient: dn/dt = (n_steady - n) / tau, tau = 2 pi I n0 / M_stall, with
///   n_steady from the line, which may be below 0: n(t) = n_steady + (n(0) - n_steady) exp(-t / tau), exact for any step. The cutting
///   torque brakes and never drives: a spindle at 0 stays at 0 until the load falls below M_stall.
#pragma once

#include "core/base/result.h"

namespace burrhole {

struct SpindleConfig {
  double free_speed = 1000.0 / 60.0;  ///< [rev/s] > 0: n0, speed without load
  double stall_torque = 2.0;          ///< [N m] > 0: M_stall (an assumption)
  double inertia = 1e-4;              ///< [kg m^2] >= 0: I of all rotating parts at the bit (an assumption); 0: no lag
};

class Spindle {
 public:
  /// Starts at the free speed. @returns out_of_range if a number of the config is outside its range.
  [[nodiscard]] static Result<Spindle> create(const SpindleConfig& config);

  /// Advances by `dt` [s] >= 0 under a constant torque [N m] >= 0. @returns the speed at the end [rev/s], never below 0.
  double step(double torque, double dt) noexcept;

  /// The motor's command [-] 0..1: M_m(n) = M_stall (command - n / n0). 0 brakes.
  void set_command(double command) noexcept { command_ = command; }
  [[nodiscard]] double speed() const noexcept { return speed_; }                 ///< [rev/s]
  [[nodiscard]] double time_constant() const noexcept { return lag_; }           ///< [s] tau
  [[nodiscard]] double steady_speed(double torque) const noexcept;               ///< [rev/s] steady-state speed under a torque [N m], >= 0
  void set_speed(double speed) noexcept { speed_ = speed > 0.0 ? speed : 0.0; }  ///< [rev/s] 0 when the motor is switched off

 private:
  explicit Spindle(const SpindleConfig& config);
  SpindleConfig config_;
  double lag_;
  double speed_;
  double command_ = 1.0;
};

}  // namespace burrhole
