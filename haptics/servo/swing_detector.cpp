#include "haptics/servo/swing_detector.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

SwingDetector::SwingDetector(const SwingConfig& config, double dt) noexcept
    : least_(config.force), dt_(dt), longest_(static_cast<std::uint64_t>(std::max(1.0, std::ceil(config.longest / dt)))) {}

bool SwingDetector::operator()(const Vec3& force) noexcept {
  if (!(least_ > 0.0)) return false;
  bool any = false;
  for (std::size_t n = 0; n < 3; ++n) {
    follow(axes_[n], force[static_cast<glm::length_t>(n)]);
    any = any || axes_[n].lasts;
  }
  ++tick_;
  return any;
}

void SwingDetector::follow(Axis& axis, double force) noexcept {
  if (axis.sign == 0.0) {
    axis.extreme = tick_ == 0 ? force : std::max(axis.extreme, force);
    axis.turned = tick_ == 0 ? force : std::min(axis.turned, force);
    if (axis.extreme - axis.turned < least_) return;
    axis.sign = force == axis.extreme ? 1.0 : -1.0;
    axis.extreme = force;
    axis.extreme_tick = axis.turned_tick = tick_;
  } else if (axis.sign * (force - axis.extreme) >= 0.0) {
    axis.extreme = force;
    axis.extreme_tick = tick_;
  } else if (axis.sign * (axis.extreme - force) >= least_) {
    turn(axis, force);
  }
  if (tick_ - axis.turned_tick > 2 * longest_) {  // a swing is known only when the next one has begun
    axis.count = 0;
    axis.lasts = false;
  }
}

/// The extreme was a turning point: the force has come back from it by a swing.
void SwingDetector::turn(Axis& axis, double force) noexcept {
  const std::uint64_t took = axis.extreme_tick - axis.turned_tick;
  if (axis.begun && took <= longest_) {
    axis.swing[axis.next] = std::abs(axis.extreme - axis.turned);
    axis.took[axis.next] = took;
    axis.next = (axis.next + 1) % kSwings;
    axis.count = std::min(axis.count + 1, kSwings);
  } else {
    axis.count = 0;
  }
  axis.begun = true;
  axis.turned = axis.extreme;
  axis.turned_tick = axis.extreme_tick;
  axis.sign = -axis.sign;
  axis.extreme = force;
  axis.extreme_tick = tick_;
  judge(axis);
}

void SwingDetector::judge(Axis& axis) noexcept {
  axis.lasts = false;
  if (axis.count < kSwings) return;
  double early = 0.0, late = 0.0;
  std::uint64_t ticks = 0;
  for (std::size_t n = 0; n < kSwings; ++n) {
    const std::size_t at = (axis.next + n) % kSwings;  // from the oldest
    (n < kSwings / 2 ? early : late) += axis.swing[at];
    ticks += axis.took[at];
  }
  axis.lasts = late >= kLasting * early;
  const double force = (early + late) / kSwings;
  if (!axis.lasts || force <= largest_.force) return;
  if (largest_.force == 0.0) largest_.tick = axis.turned_tick - ticks;
  largest_.force = force;
  largest_.frequency = 0.5 * kSwings / (static_cast<double>(ticks) * dt_);
}

}  // namespace burrhole
