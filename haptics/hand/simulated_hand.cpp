#include "haptics/hand/simulated_hand.h"

#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kAdvanceFilter = 0.005;  // [s] of the speed in which a give is felt
constexpr double kSettling = 0.5;         // [s] after the ramp before a give can be felt: the lean itself moves the hand

}  // namespace

SimulatedHand::SimulatedHand(const HandConfig& config, const Pose& world_from_approach, double period, const MassSpringDamper& body)
    : config_(config), world_from_approach_(world_from_approach), period_(period), body_(body) {
  goal_height_ = config.standoff;
  position_ = Vec3(0.0, 0.0, config.standoff);
  state_.world_from_hand = {world_from_approach.rotation, world_from_approach * position_};
}

Result<SimulatedHand> SimulatedHand::create(const HandConfig& config, const Pose& world_from_approach, double period) {
  for (const double value : {config.feed, config.push, config.ramp, config.reaction, config.release, config.contact_force,
                             config.give_speed, config.standoff, config.tremor_amplitude, config.tremor_frequency})
    if (!(std::isfinite(value) && value >= 0.0))
      return Error{ErrorCode::out_of_range, "a value of the hand's script is negative or not finite", {}};
  if (!(config.follow_time > 0.0)) return Error{ErrorCode::out_of_range, "the hand's follow time must be above 0", {}};
  auto body = MassSpringDamper::create(config.dynamics, period);
  if (!body) return body.error();
  return SimulatedHand(config, world_from_approach, period, *body);
}

Vec3 SimulatedHand::tremor() const noexcept {
  const double t = static_cast<double>(state_.tick) * period_;
  // Two axes, slightly different rates and seeded phases: never a straight line.
  const auto wave = [&](std::uint64_t axis, double ratio) {
    const double phase = 2.0 * std::numbers::pi * (config_.tremor_frequency * ratio * t + uniform01(config_.seed, axis));
    return config_.tremor_amplitude * portable_sin(phase);
  };
  return {wave(1, 1.0), wave(2, 1.13), 0.0};
}

const HandState& SimulatedHand::step(const Vec3& force_on_hand) noexcept {
  const Vec3 felt = config_.feels ? glm::conjugate(world_from_approach_.rotation) * force_on_hand : Vec3(0.0);
  follow_script(felt.z);
  const Vec3 goal = Vec3(0.0, 0.0, goal_height_) + tremor();
  body_.step(position_, velocity_, felt + Vec3(0.0, 0.0, -state_.thrust) + goal * config_.dynamics.stiffness);
  advance_ += (-velocity_.z - advance_) * std::min(1.0, period_ / kAdvanceFilter);
  ++state_.tick;
  state_.world_from_hand.translation = world_from_approach_ * position_;
  state_.velocity = world_from_approach_.rotate(velocity_);
  return state_;
}

void SimulatedHand::follow_script(double felt) noexcept {
  const std::uint64_t tick = state_.tick;
  const auto seconds_since = [&](std::uint64_t since) { return static_cast<double>(tick - since) * period_; };
  switch (state_.phase) {
    case HandPhase::approach:
      goal_height_ -= config_.feed * period_;
      if (felt > config_.contact_force) {
        state_.phase = HandPhase::lean;
        lean_tick_ = tick;
      }
      break;
    case HandPhase::lean:
    case HandPhase::give_felt: {
      const double ramp = config_.ramp > 0.0 ? std::min(1.0, seconds_since(lean_tick_) / config_.ramp) : 1.0;
      state_.thrust = config_.push * ramp;
      goal_height_ += (position_.z - goal_height_) * std::min(1.0, period_ / config_.follow_time);
      if (state_.phase == HandPhase::lean && seconds_since(lean_tick_) > config_.ramp + kSettling && advance_ > config_.give_speed) {
        state_.phase = HandPhase::give_felt;
        give_tick_ = tick;
      }
      if (state_.phase == HandPhase::give_felt && seconds_since(give_tick_) >= config_.reaction) {
        state_.phase = HandPhase::release;
        release_tick_ = tick;
        release_thrust_ = state_.thrust;
      }
      break;
    }
    case HandPhase::release: {
      // The arm stays where it is while the muscles let go: dropped at once, the springs of arm and drill would throw the bit out.
      const double left = config_.release > 0.0 ? 1.0 - seconds_since(release_tick_) / config_.release : 0.0;
      state_.thrust = release_thrust_ * std::max(0.0, left);
      goal_height_ += (position_.z - goal_height_) * std::min(1.0, period_ / config_.follow_time);
      if (left <= 0.0) state_.phase = HandPhase::withdraw;
      break;
    }
    case HandPhase::withdraw:
      goal_height_ += 2.0 * config_.feed * period_;
      if (goal_height_ >= config_.standoff) {
        goal_height_ = config_.standoff;
        if (position_.z > 0.9 * config_.standoff) state_.phase = HandPhase::done;
      }
      break;
    case HandPhase::done:
      break;
  }
}

}  // namespace burrhole
