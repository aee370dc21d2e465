#include "haptics/servo/tip_vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {

Result<TipVibration> TipVibration::create(const TipVibrationConfig& config) {
  if (!(config.amplitude >= 0.0 && std::isfinite(config.amplitude)) || !(config.cycles > 0.0 && std::isfinite(config.cycles)))
    return Error{ErrorCode::out_of_range, "the amplitude of a vibration must be at least 0 and its cycles per revolution above 0", {}};
  return TipVibration(config);
}

Vec3 TipVibration::operator()(double spin, const Vec3& axis, double dt) noexcept {
  if (!(spin > 0.0)) return Vec3(0.0);
  phase_ += std::min(spin * config_.cycles * dt, kHighest);
  phase_ -= std::floor(phase_);
  const double angle = 2.0 * std::numbers::pi * phase_;
  return rotation_from_z(axis) * Vec3(config_.amplitude * portable_cos(angle), config_.amplitude * portable_sin(angle), 0.0);
}

}  // namespace burrhole
