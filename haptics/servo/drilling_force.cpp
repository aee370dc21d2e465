#include "haptics/servo/drilling_force.h"

#include <cmath>

#include "core/base/portable_math.h"

namespace burrhole {

Result<DrillingForce> DrillingForce::create(const DrillingForceConfig& config) {
  const auto above_zero = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!above_zero(config.resistance) || !above_zero(config.time))
    return Error{ErrorCode::out_of_range, "drilling force: resistance and time constant must be above 0", {}};
  auto passive = PassiveForce::create(config.limit);
  if (!passive) return passive.error();
  return DrillingForce(config, *passive);
}

void DrillingForce::restart() noexcept {
  passive_.restart();
  velocity_ = Vec3(0.0);
  known_ = false;
}

Vec3 DrillingForce::operator()(const Vec3& hand, const Vec3& drill, const Vec3& towards, double dt) noexcept {
  if (is_finite(drill) && dt > 0.0) {
    const Vec3 moved = known_ ? drill - before_ : Vec3(0.0);
    velocity_ += (moved / dt - velocity_) * (1.0 - portable_exp(-dt / config_.time));
    before_ = drill;
    known_ = true;
  }
  return passive_(hand, -config_.resistance * glm::length(velocity_) * towards, dt);
}

}  // namespace burrhole
