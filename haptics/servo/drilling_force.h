/// haptics/servo/drilling_force.h: the resistance of bone to a drill that moves: opposite to the bone before it, in proportion to the speed.
///   Frame  world.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Force  F = -k |v| b / |b|, with b from the middle of the bit to the balance point (core/drill/balance_point.h) and v the velocity of the
///          drill, averaged with the time constant T: dv/dt = (moved / dt - v) / T, exact for any tick. It is limited by passive_force.h: as
///          printed the force also pushes a drill that moves out of bone, which adds energy.
///   Source [Petersik03] section 3.4, eq. 2. There |v| is the way since the last stored position, so the force depends on how often that is
///          stored; here k has a unit and T is stated, and rates of 1 and 6 kHz give the same force.
#pragma once

#include "haptics/servo/passive_force.h"

namespace burrhole {

struct DrillingForceConfig {
  double resistance = 100.0;  ///< [N s/m] > 0: k (an assumption)
  double time = 10e-3;        ///< [s] > 0: T (an assumption)
  PassiveForceConfig limit{};
};

class DrillingForce {
 public:
  [[nodiscard]] static Result<DrillingForce> create(const DrillingForceConfig& config);
  /// @param hand [m] position that the force acts on. @param drill [m] position of the drill; bone holds it back. @param towards length 0 to 1,
  /// along b; 0: no bone. @returns the force [N] on the hand until the next call, `dt` [s] later. An argument that is not finite gives no
  /// force.
  [[nodiscard]] Vec3 operator()(const Vec3& hand, const Vec3& drill, const Vec3& towards, double dt) noexcept BH_REALTIME;
  /// As PassiveForce::restart(); the drill is at rest.
  void restart() noexcept;
  [[nodiscard]] const PassiveForceFigures& figures() const noexcept { return passive_.figures(); }

 private:
  DrillingForce(const DrillingForceConfig& config, const PassiveForce& passive) : config_(config), passive_(passive) {}
  DrillingForceConfig config_;
  PassiveForce passive_;
  Vec3 before_{0.0}, velocity_{0.0};  // [m], [m/s] of the drill
  bool known_ = false;                // before_ is
};

}  // namespace burrhole
