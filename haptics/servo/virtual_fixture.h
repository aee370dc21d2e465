/// haptics/servo/virtual_fixture.h: a force that keeps a hand from a forbidden region and adds no energy: a penalty with damping, limited by
///   passive_force.h.
///   Frame  world.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Force   along the unit vector n away from the region, at the depth p below the start of the fixture: f = K p + B max(0, -v n), at most
///           F_max, and at most what keeps it passive.
///   Source  own derivation.
#pragma once

#include "haptics/servo/passive_force.h"

namespace burrhole {

struct FixtureConfig {
  double start = 0.5e-3;      ///< [m] >= 0: distance from the region at which the force begins (an assumption)
  double stiffness = 2000.0;  ///< [N/m] > 0: K (an assumption)
  double damping = 5.0;       ///< [N s/m] >= 0: B (an assumption)
  double largest = 8.0;       ///< [N] > 0: F_max (an assumption: what a small device renders)
  PassiveForceConfig limit{};
};

class VirtualFixture {
 public:
  [[nodiscard]] static Result<VirtualFixture> create(const FixtureConfig& config);
  /// @param hand [m] position that the force acts on. @param distance [m] of what is guarded from the region, negative inside.
  /// @param away unit, or 0: no force. @returns the force [N] on the hand until the next call, `dt` [s] later. An argument that is not finite
  /// gives no force.
  [[nodiscard]] Vec3 operator()(const Vec3& hand, double distance, const Vec3& away, double dt) noexcept BH_REALTIME;
  /// As PassiveForce::restart().
  void restart() noexcept { passive_.restart(); }
  [[nodiscard]] const PassiveForceFigures& figures() const noexcept { return passive_.figures(); }

 private:
  VirtualFixture(const FixtureConfig& config, const PassiveForce& passive) : config_(config), passive_(passive) {}
  FixtureConfig config_;
  PassiveForce passive_;
};

}  // namespace burrhole
