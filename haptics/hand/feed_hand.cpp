#include "haptics/hand/feed_hand.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace burrhole {
namespace {

constexpr double kUnload = 1.0;  // [m/s] of the carriage while it takes the load off the coupling; the bit cuts on until that is over
// [s] Where the bit advances at once, as after an erosion step, the coupling's damper lowers the force for some milliseconds. So its
// compression follows from the largest force of this time at least, and of twice this time at most.
constexpr double kDamped = 5e-3;

}  // namespace

FeedHand::FeedHand(const FeedHandConfig& config, const Pose& world_from_approach, double period, const MassSpringDamper& carriage)
    : config_(config),
      world_from_approach_(world_from_approach),
      period_(period),
      carriage_(carriage),
      damped_ticks_(std::max(1ll, std::llround(kDamped / period))),
      height_(config.standoff) {
  state_.world_from_hand = {world_from_approach.rotation, world_from_approach * Vec3(0.0, 0.0, height_)};
}

Result<FeedHand> FeedHand::create(const FeedHandConfig& config, const Pose& world_from_approach, double period) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const auto at_least_zero = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!(positive(config.feed) && positive(config.contact_force) && positive(config.standoff)))
    return Error{ErrorCode::out_of_range, "feed, contact force and standoff of the bench must be above 0", {}};
  if (!(at_least_zero(config.stop) && at_least_zero(config.ramp) && at_least_zero(config.compliance)))
    return Error{ErrorCode::out_of_range, "stop, ramp and compliance of the bench must be at least 0", {}};
  if (config.push && !positive(*config.push)) return Error{ErrorCode::out_of_range, "the thrust of the bench must be above 0", {}};
  auto carriage = MassSpringDamper::create({config.mass, config.damping, 0.0}, period);
  if (!carriage) return carriage.error();
  return FeedHand(config, world_from_approach, period, *carriage);
}

double FeedHand::thrust() const noexcept {
  const double since = static_cast<double>(state_.tick - lean_tick_) * period_;
  const double share = config_.ramp > 0.0 ? std::min(1.0, since / config_.ramp) : 1.0;
  return contact_thrust_ + (*config_.push - contact_thrust_) * share;
}

void FeedHand::advance(double felt) noexcept {
  const double before = height_;
  if (state_.phase == HandPhase::approach && felt > config_.contact_force) {
    state_.phase = HandPhase::lean;
    lean_tick_ = state_.tick;
    contact_thrust_ = std::min(felt, config_.push.value_or(felt));
  }
  if (config_.push && state_.phase == HandPhase::lean) {
    state_.thrust = thrust();
    carriage_.step(height_, climb_, felt - state_.thrust);
  } else {
    state_.thrust = std::max(0.0, felt);
    climb_ = -config_.feed;
    height_ += climb_ * period_;
  }
  if (state_.tick % damped_ticks_ == 0) largest_before_ = std::exchange(largest_, 0.0);
  largest_ = std::max(largest_, felt);
  if (felt < config_.contact_force) largest_ = largest_before_ = std::max(0.0, felt);  // bone has ended
  const double lowest = -(config_.stop + std::max(largest_, largest_before_) * config_.compliance);
  if (height_ > lowest) return;
  height_ = std::min(lowest, before);  // the force may have fallen since the carriage was there
  climb_ = 0.0;
  state_.phase = HandPhase::withdraw;
}

void FeedHand::withdraw() noexcept {
  state_.thrust = 0.0;
  height_ += climb_ * period_;
  if (height_ < config_.standoff) return;
  height_ = config_.standoff;
  climb_ = 0.0;
  state_.phase = HandPhase::done;
}

void FeedHand::apply(const Wrench& on_hand) noexcept {
  const double felt = (glm::conjugate(world_from_approach_.rotation) * on_hand.force).z;
  if (state_.phase == HandPhase::approach || state_.phase == HandPhase::lean) {
    advance(felt);
  } else if (state_.phase == HandPhase::withdraw) {
    climb_ = std::max(2.0 * config_.feed, std::min(kUnload, felt * config_.compliance / period_));
    withdraw();
  }
  ++state_.tick;
  state_.world_from_hand.translation = world_from_approach_ * Vec3(0.0, 0.0, height_);
  state_.velocity = world_from_approach_.rotate(Vec3(0.0, 0.0, climb_));
}

}  // namespace burrhole
