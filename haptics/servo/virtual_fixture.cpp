#include "haptics/servo/virtual_fixture.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Result<VirtualFixture> VirtualFixture::create(const FixtureConfig& config) {
  const auto above_zero = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!(config.start >= 0.0 && std::isfinite(config.start)) || !(config.damping >= 0.0 && std::isfinite(config.damping)) ||
      !above_zero(config.stiffness) || !above_zero(config.largest) || !above_zero(config.allowance) || !above_zero(config.acceleration))
    return Error{ErrorCode::out_of_range, "virtual fixture: start and damping must be at least 0, the other values above 0", {}};
  return VirtualFixture(config);
}

void VirtualFixture::restart() noexcept {
  known_ = false;
  force_ = Vec3(0.0);
  figures_.taken = 0.0;
}

Vec3 VirtualFixture::operator()(const Vec3& hand, double distance, const Vec3& away, double dt) noexcept {
  if (!is_finite(hand) || !std::isfinite(distance) || !is_finite(away) || !(dt > 0.0)) {
    known_ = false;
    force_ = Vec3(0.0);
    return Vec3(0.0);
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
  const double depth = config_.start - distance;
  if (!(depth > 0.0)) {
    if (jumped_) figures_.taken = std::max(figures_.taken, 0.0);
    jumped_ = false;
    return force_;
  }
  if (away == Vec3(0.0)) return force_;
  double size = config_.stiffness * depth + config_.damping * std::max(0.0, -glm::dot(moved, away) / dt);
  size = std::min(size, config_.largest);
  if (const double most = std::max(0.0, figures_.taken + config_.allowance) / bound_; size > most) {
    size = most;
    ++figures_.limited;
  }
  force_ = size * away;
  figures_.peak = std::max(figures_.peak, size);
  return force_;
}

}  // namespace burrhole
