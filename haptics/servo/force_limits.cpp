#include "haptics/servo/force_limits.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Vec3 shortened(const Vec3& v, double longest) noexcept {
  const double length = glm::length(v);
  if (length <= longest) return v;
  if (std::isfinite(length)) return v * (longest / length);
  const Vec3 unit = v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return unit * (longest / glm::length(unit));
}

Vec3 SlewLimit::operator()(const Vec3& wanted) noexcept {
  if (!(per_tick_ > 0.0) || std::isinf(per_tick_)) {
    shown_ = wanted;
    return shown_;
  }
  const Vec3 change = wanted - shown_;
  const Vec3 allowed = shortened(change, per_tick_);
  limited_ = allowed != change;
  share_ = limited_ ? glm::length(allowed) / glm::length(change) : 1.0;
  shown_ = limited_ ? shown_ + allowed : wanted;
  return shown_;
}

SoftGain::SoftGain(double soft_start, double soft_stop, double dt) noexcept
    : rise_(soft_start > 0.0 ? dt / soft_start : 1.0), fall_(soft_stop > 0.0 ? dt / soft_stop : 1.0) {}

double SoftGain::operator()(bool on) noexcept {
  gain_ = on ? std::min(1.0, gain_ + rise_) : std::max(0.0, gain_ - fall_);
  return gain_;
}

}  // namespace burrhole
