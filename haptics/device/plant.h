/// haptics/device/plant.h: a device in a hand: mass, damping, the hand's spring and Coulomb friction under a force held over a tick.
///   m x'' + b x' + k (x - rest) = force - f_c sign(x'), and at rest it stays while |force - k (x - rest)| <= f_c.
///   Integrated exactly: between events the sign is fixed and the motion linear (MassSpringDamper); the moment at which the velocity passes
///   zero is found by halving the tick down to its last bit, with the flow of each half known beforehand.
///   Three axes apart from each other, friction too: it is a box of forces, up to sqrt(3) f_c on the diagonal. Against the direction of
///   motion friction has no exact solution in three dimensions, and in a real arm it acts in the joints, not in the grip.
///   Frame  any, axes as the friction's.   Units SI.   Thread servo.   Source own derivation.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct PlantConfig {
  MassSpringDamperConfig body{0.1, 0.5, 0.0};  ///< totals of device and hand; the spring is the hand's
  double friction = 0.0;                       ///< [N] >= 0, Coulomb
};

struct PlantState {
  Vec3 position{0.0};  ///< [m]
  Vec3 velocity{0.0};  ///< [m/s]
};

struct PlantInput {
  Vec3 force{0.0};  ///< [N] every force but the hand's spring, damping and friction
  Vec3 rest{0.0};   ///< [m] where the hand's spring is at rest
};

class Plant {
 public:
  /// out_of_range as MassSpringDamper; friction negative or not finite; with friction, a period of half an oscillation or more: an axis
  /// then could stop twice within a tick.
  [[nodiscard]] static Result<Plant> create(const PlantConfig& config, double period);
  /// One tick under a held input.
  void step(PlantState& state, const PlantInput& input) const noexcept BH_REALTIME;

 private:
  static constexpr int kHalvings = 52;  // the tick's last bit

  /// `held` [N]: force and pull of the spring at 0.
  void step_axis(double& x, double& v, double held) const noexcept;
  /// Goes to the last moment at which the velocity has still that sign. @returns what is left of the tick, in units of 2^-kHalvings of it.
  std::uint64_t go_to_stop(double& x, double& v, double input, double sign) const noexcept;
  void go_on(double& x, double& v, double input, std::uint64_t units) const noexcept;
  /// +1 or -1: the way an axis at rest starts to move; 0: it stays.
  [[nodiscard]] double sign_out_of_rest(double x, double held) const noexcept;

  double stiffness_ = 0.0, friction_ = 0.0;
  std::array<MassSpringDamper, kHalvings + 1> flow_;  // of the tick, its half, its quarter, ...
};

}  // namespace burrhole
