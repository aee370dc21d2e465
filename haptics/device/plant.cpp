#include "haptics/device/plant.h"

#include <cmath>
#include <numbers>

namespace burrhole {

Result<Plant> Plant::create(const PlantConfig& config, double period) {
  if (!(std::isfinite(config.friction) && config.friction >= 0.0))
    return Error{ErrorCode::out_of_range, "friction must be finite and at least 0", {}};
  Plant out;
  for (int n = 0; n <= kHalvings; ++n) {
    auto flow = MassSpringDamper::create(config.body, std::ldexp(period, -n));
    if (!flow) return flow.error();
    out.flow_[static_cast<std::size_t>(n)] = *flow;
  }
  // While the sign of the friction is constant, the velocity is a free oscillation: its zeros are half an oscillation apart for any force.
  // A shorter tick contains one zero at most, and the signs at its ends show whether it does.
  const double half_damping = 0.5 * config.body.damping / config.body.mass;
  const double angular2 = config.body.stiffness / config.body.mass - half_damping * half_damping;  // [rad^2/s^2]
  if (config.friction > 0.0 && angular2 * period * period >= std::numbers::pi * std::numbers::pi)
    return Error{ErrorCode::out_of_range, "with friction the period must be under half an oscillation of mass and hand spring", {}};
  out.stiffness_ = config.body.stiffness;
  out.friction_ = config.friction;
  return out;
}

void Plant::step(PlantState& state, const PlantInput& input) const noexcept {
  const Vec3 held = input.force + input.rest * stiffness_;
  if (friction_ == 0.0) {
    flow_[0].step(state.position, state.velocity, held);
    return;
  }
  for (int axis = 0; axis < 3; ++axis) step_axis(state.position[axis], state.velocity[axis], held[axis]);
}

void Plant::step_axis(double& x, double& v, double held) const noexcept {
  double sign = v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : sign_out_of_rest(x, held);
  if (sign == 0.0) return;
  double end_x = x, end_v = v;
  flow_[0].step(end_x, end_v, held - sign * friction_);
  if (v == 0.0 || sign * end_v > 0.0) {
    x = end_x;
    v = end_v;
    return;
  }
  const std::uint64_t left = go_to_stop(x, v, held - sign * friction_, sign);
  v = 0.0;
  sign = sign_out_of_rest(x, held);
  if (sign != 0.0) go_on(x, v, held - sign * friction_, left);
}

double Plant::sign_out_of_rest(double x, double held) const noexcept {
  const double force = held - stiffness_ * x;
  if (std::abs(force) <= friction_) return 0.0;
  return force > 0.0 ? 1.0 : -1.0;
}

std::uint64_t Plant::go_to_stop(double& x, double& v, double input, double sign) const noexcept {
  std::uint64_t left = std::uint64_t{1} << kHalvings;
  for (int n = 1; n <= kHalvings; ++n) {
    double next_x = x, next_v = v;
    flow_[static_cast<std::size_t>(n)].step(next_x, next_v, input);
    if (sign * next_v <= 0.0) continue;
    x = next_x;
    v = next_v;
    left -= std::uint64_t{1} << (kHalvings - n);
  }
  return left;
}

void Plant::go_on(double& x, double& v, double input, std::uint64_t units) const noexcept {
  for (int n = 0; n <= kHalvings; ++n)
    if ((units >> (kHalvings - n) & 1u) != 0) flow_[static_cast<std::size_t>(n)].step(x, v, input);
}

}  // namespace burrhole
