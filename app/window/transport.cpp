#include "app/window/transport.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

constexpr double kAhead = 0.1;  // [s] of real time that the head may be ahead of a replay that is slower than the speed asked for

}  // namespace

Transport::Transport(double duration, double tick) noexcept : duration_(std::max(0.0, duration)), tick_(tick) {}

void Transport::run(bool runs) noexcept {
  if (runs && !runs_ && head_ > duration_ - 0.5 * tick_) jump(0.0);
  runs_ = runs;
}

void Transport::set_speed(double speed) noexcept {
  if (std::isfinite(speed)) speed_ = std::clamp(speed, kSlowest, kFastest);
}

void Transport::jump(double time) noexcept {
  if (!std::isfinite(time)) return;
  head_ = std::clamp(time, 0.0, duration_);
  seeks_ = is_behind() || !has_arrived();
}

void Transport::step(double by) noexcept {
  runs_ = false;
  jump(head_ + by);
}

void Transport::advance(double dt) noexcept {
  if (!runs_ || seeks_ || !(dt > 0.0)) return;
  const double furthest = std::max(head_, arrived_ + std::max(tick_, kAhead * speed_));
  head_ = std::min({head_ + speed_ * dt, furthest, duration_});
  if (head_ >= duration_ && has_arrived()) runs_ = false;
}

void Transport::end_at(double time) noexcept {
  duration_ = std::max(0.0, time);
  if (head_ > duration_) jump(duration_);
}

void Transport::arrive(double time) noexcept {
  arrived_ = time;
  if (seeks_ && !is_behind() && has_arrived()) seeks_ = false;
}

}  // namespace burrhole
