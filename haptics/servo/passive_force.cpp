#include "haptics/servo/passive_force.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Result<PassiveForce> PassiveForce::create(const PassiveForceConfig& config) {
  const auto above_zero = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!above_zero(config.allowance) || !above_zero(config.acceleration))
    return Error{ErrorCode::out_of_range, "passive force: allowance and acceleration must be above 0", {}};
  return PassiveForce(config);
}

void PassiveForce::restart() noexcept {
  known_ = false;
  force_ = Vec3(0.0);
  figures_.taken = 0.0;
}

Vec3 PassiveForce::operator()(const Vec3& hand, const Vec3& wanted, double dt) noexcept {
  if (!is_finite(hand) || !is_finite(wanted) || !(dt > 0.0)) {
    known_ = false;
    force_ = Vec3(0.0);
    return force_;
  }
  const Vec3 moved = known_ ? hand - before_ : Vec3(0.0);
  const double length = glm::length(moved);
  figures_.taken -= glm::dot(force_, moved);
  figures_.most_given = std::max(figures_.most_given, -figures_.taken);
  if (force_ != Vec3(0.0) && length > bound_) {
    ++figures_.jumps;
    jumped_ = true;
  }
  before_ = hand;
  known_ = true;
  bound_ = length + config_.acceleration * dt * dt;
  force_ = Vec3(0.0);
  double size = glm::length(wanted);
  if (size == 0.0) {
    if (jumped_) figures_.taken = std::max(figures_.taken, 0.0);
    jumped_ = false;
    return force_;
  }
  const Vec3 direction = wanted / size;
  if (const double most = std::max(0.0, figures_.taken + config_.allowance) / bound_; size > most) {
    size = most;
    ++figures_.limited;
  }
  force_ = size * direction;
  figures_.peak = std::max(figures_.peak, size);
  return force_;
}

}  // namespace burrhole
