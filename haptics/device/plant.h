/// haptics/device/plant.h: device and hand as one body: mass, damping, the hand's spring and Coulomb friction, under a force that is
/// constant
///   during a tick.
///   m x'' + b x' + k (x - rest) = force - f_c sign(x'). A body at rest stays at rest while |force - k (x - rest)| <= f_c.
///   The integration is exact. Between zeros of the velocity its sign is fixed and the motion is linear (MassSpringDamper). The time at
///   which the velocity passes zero is found by bisection of the tick to its last bit, with the precomputed flow of each half. The three
///   axes are independent, friction included: the set of friction forces is a box, up to sqrt(3) f_c on the diagonal. Friction against the
///   direction of motion has no exact solution in three dimensions; in a real arm it acts in the joints.
///   Frame  any; the axes are those of the friction.   Units  SI.   Errors  out_of_range from create().   Thread  servo.
///   Source own derivation.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct PlantConfig {
  MassSpringDamperConfig body{0.1, 0.5, 0.0};  ///< sums of device and hand; the spring is that of the hand
  double friction = 0.0;                       ///< [N] >= 0, Coulomb friction
};

struct PlantState {
  Vec3 position{0.0};  ///< [m]
  Vec3 velocity{0.0};  ///< [m/s]
};

struct PlantInput {
  Vec3 force{0.0};  ///< [N] every force except the hand's spring, damping and friction
  Vec3 rest{0.0};   ///< [m] rest position of the hand's spring
};

class Plant {
 public:
  /// @param period [s] of a tick. @returns out_of_range as MassSpringDamper; if friction is negative or not finite; or if friction is > 0
  /// and the period is at least half an oscillation: an axis could then stop twice within a tick.
  [[nodiscard]] static Result<Plant> create(const PlantConfig& config, double period);
  /// Advances by one tick under constant input.
  void step(PlantState& state, const PlantInput& input) const noexcept BH_REALTIME;

 private:
  static constexpr int kHalvings = 52;  // down to the last bit of the tick

  /// `held` [N]: input force plus the spring force at x = 0, constant during the tick.
  void step_axis(double& x, double& v, double held) const noexcept;
  /// Advances to the last time at which the velocity has this sign. @returns the rest of the tick, in units of 2^-kHalvings of it.
  std::uint64_t go_to_stop(double& x, double& v, double input, double sign) const noexcept;
  void go_on(double& x, double& v, double input, std::uint64_t units) const noexcept;
  /// +1 or -1: direction in which an axis at rest starts to move; 0: it stays at rest.
  [[nodiscard]] double sign_out_of_rest(double x, double held) const noexcept;

  double stiffness_ = 0.0, friction_ = 0.0;
  std::array<MassSpringDamper, kHalvings + 1> flow_;  // of the tick, its half, its quarter, ...
};

}  // namespace burrhole
