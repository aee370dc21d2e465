#include "haptics/servo/virtual_fixture.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Result<VirtualFixture> VirtualFixture::create(const FixtureConfig& config) {
  const auto at_least_zero = [](double value) { return value >= 0.0 && std::isfinite(value); };
  const auto above_zero = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!at_least_zero(config.start) || !at_least_zero(config.damping) || !above_zero(config.stiffness) || !above_zero(config.largest))
    return Error{ErrorCode::out_of_range, "virtual fixture: start and damping must be at least 0, stiffness and largest force above 0", {}};
  auto passive = PassiveForce::create(config.limit);
  if (!passive) return passive.error();
  return VirtualFixture(config, *passive);
}

Vec3 VirtualFixture::operator()(const Vec3& hand, double distance, const Vec3& away, double dt) noexcept {
  const double depth = config_.start - distance;
  if (!(depth > 0.0)) return passive_(hand, Vec3(0.0), dt);
  const double towards = std::max(0.0, -glm::dot(passive_.moved(hand), away) / dt);
  return passive_(hand, std::min(config_.stiffness * depth + config_.damping * towards, config_.largest) * away, dt);
}

}  // namespace burrhole
