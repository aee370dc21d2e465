#include "core/drill/spindle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {

Spindle::Spindle(const SpindleConfig& config)
    : config_(config), lag_(2.0 * std::numbers::pi * config.inertia * config.free_speed / config.stall_torque), speed_(config.free_speed) {}

Result<Spindle> Spindle::create(const SpindleConfig& config) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(config.free_speed > 0.0 && std::isfinite(config.free_speed))) return refuse("the spindle's free speed must be a number above 0");
  if (!(config.stall_torque > 0.0 && std::isfinite(config.stall_torque)))
    return refuse("the spindle's stall torque must be a number above 0");
  if (!(config.inertia >= 0.0 && std::isfinite(config.inertia))) return refuse("the spindle's inertia must be a number, 0 or more");
  return Spindle(config);
}

double Spindle::step(double torque, double dt) noexcept {
  if (!(dt > 0.0)) return speed_;
  const double load = torque > 0.0 ? torque : 0.0;  // a NaN torque counts as 0
  const double steady = config_.free_speed * (command_ - load / config_.stall_torque);
  const double keep = lag_ > 0.0 ? portable_exp(-dt / lag_) : 0.0;
  speed_ = std::max(0.0, steady + (speed_ - steady) * keep);
  return speed_;
}

double Spindle::steady_speed(double torque) const noexcept {
  return config_.free_speed * std::clamp(1.0 - torque / config_.stall_torque, 0.0, 1.0);
}

}  // namespace burrhole
