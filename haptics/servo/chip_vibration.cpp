#include "haptics/servo/chip_vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

/// Advances a phase by `cycles` of a tick. @returns the force in the plane across the axis, of size `size` in the band.
Vec3 turning(double& phase, double cycles, double size) noexcept {
  phase += cycles;
  phase -= std::floor(phase);
  const double band = std::clamp((ChipVibration::kNone - cycles) / (ChipVibration::kNone - ChipVibration::kWhole), 0.0, 1.0);
  const double angle = 2.0 * std::numbers::pi * phase;
  return band * size * Vec3(portable_cos(angle), portable_sin(angle), 0.0);
}

}  // namespace

Result<ChipVibration> ChipVibration::create(const ChipVibrationConfig& config) {
  const auto above_zero = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!above_zero(config.fracture) || !above_zero(config.rise) || !(config.uneven >= 0.0 && std::isfinite(config.uneven)))
    return Error{
        ErrorCode::out_of_range, "vibration by chips: thickness at fracture and time constant must be above 0, unevenness at least 0", {}};
  return ChipVibration(config);
}

Vec3 ChipVibration::operator()(const ToothLoad& load, double spin, const Vec3& axis, double dt) noexcept {
  const double wanted = spin > 0.0 ? load.force * load.thickness / (load.thickness + config_.fracture) : 0.0;
  size_ += (wanted - size_) * (1.0 - portable_exp(-dt / config_.rise));
  if (!(spin > 0.0)) return Vec3(0.0);
  const double turns = spin * dt;
  return rotation_from_z(axis) * (turning(tooth_, turns * load.teeth, size_) + turning(turn_, turns, config_.uneven * size_));
}

}  // namespace burrhole
