#include "core/measure/support_loss.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

void SupportMonitor::look(double time, double depth, double thrust, bool beyond) noexcept {
  const double dt = std::max(0.0, time - last_time_);
  last_time_ = time;
  const bool touches = thrust > kSupportForce;
  const bool supported = touches && thrust >= kSupportShare * steady_;
  if (touches) steady_ = ever_held_ ? thrust + (steady_ - thrust) * std::exp(-dt / kSteadyTime) : thrust;
  if (!now_ && !supported && beyond) now_ = ever_held_ ? SupportLoss{held_time_, held_, 0.0} : SupportLoss{time, depth, 0.0};
  if (now_) {
    now_->plunge = std::max(now_->plunge, depth - now_->depth);
    if (!worst_ || now_->plunge > worst_->plunge || now_->time == worst_->time) worst_ = now_;
    if (!supported) regained_.reset();
    if (supported && !regained_) regained_ = time;
    if (regained_ && time - *regained_ >= kRegainTime) now_.reset(), regained_.reset();
  }
  if (!supported) return;
  ever_held_ = true;
  held_time_ = time;
  held_ = depth;
}

void SupportMonitor::forget() noexcept {
  now_.reset(), worst_.reset(), regained_.reset();
  ever_held_ = false;
}

}  // namespace burrhole
