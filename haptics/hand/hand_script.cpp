#include "haptics/hand/hand_script.h"

#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kAdvanceFilter = 0.005;  // [s] time constant of the filtered speed for breakthrough detection
constexpr double kUsualFilter = 0.3;      // [s] of the usual speed and force
constexpr double kEngages = 0.5;          // [s] after a change of the drive's speed

}  // namespace

HandScript::HandScript(const HandScriptConfig& config, double period) : config_(config), period_(period), goal_height_(config.standoff) {}

Result<HandScript> HandScript::create(const HandScriptConfig& config, double period) {
  for (const double value :
       {config.feed, config.push, config.ramp, config.reaction, config.release, config.contact_force, config.give_speed, config.give_ratio,
        config.give_distance, config.give_force, config.reach, config.standoff, config.tremor_amplitude, config.tremor_frequency})
    if (!(std::isfinite(value) && value >= 0.0))
      return Error{ErrorCode::out_of_range, "a value of the hand's script is negative or not finite", {}};
  if (!(config.follow_time > 0.0)) return Error{ErrorCode::out_of_range, "the hand's follow time must be above 0", {}};
  if (!(std::isfinite(period) && period > 0.0))
    return Error{ErrorCode::out_of_range, "the period of the hand's script must be above 0", {}};
  return HandScript(config, period);
}

Vec3 HandScript::tremor() const noexcept {
  const double t = static_cast<double>(tick_) * period_;
  // Two axes with slightly different frequencies and seeded phases, so that the path is not a line.
  const auto wave = [&](std::uint64_t axis, double ratio) {
    const double phase = 2.0 * std::numbers::pi * (config_.tremor_frequency * ratio * t + uniform01(config_.seed, axis));
    return config_.tremor_amplitude * portable_sin(phase);
  };
  return {wave(1, 1.0), wave(2, 1.13), 0.0};
}

const HandGoal& HandScript::advance(double felt, double height, double climb) noexcept {
  advance_ += (-climb - advance_) * std::min(1.0, period_ / kAdvanceFilter);
  follow(felt, height);
  goal_.rest = Vec3(0.0, 0.0, goal_height_) + tremor();
  ++tick_;
  return goal_;
}

void HandScript::follow(double felt, double height) noexcept {
  switch (phase_) {
    case HandPhase::approach:
      goal_height_ -= config_.feed * period_;
      if (felt > config_.contact_force) {
        phase_ = HandPhase::lean;
        lean_tick_ = tick_;
        usual_ = advance_;
        usual_felt_ = felt;
      }
      break;
    case HandPhase::lean:
    case HandPhase::give_felt:
      lean(felt, height);
      break;
    case HandPhase::release: {
      // The rest position follows the hand while the thrust falls. If it stopped at once, the springs of arm and drill would eject the bit.
      const double left = config_.release > 0.0 ? 1.0 - seconds_since(release_tick_) / config_.release : 0.0;
      goal_.thrust = release_thrust_ * std::max(0.0, left);
      goal_height_ += (height - goal_height_) * std::min(1.0, period_ / config_.follow_time);
      if (left <= 0.0) phase_ = HandPhase::withdraw;
      break;
    }
    case HandPhase::withdraw:
      goal_height_ += 2.0 * config_.feed * period_;
      if (goal_height_ >= config_.standoff) {
        goal_height_ = config_.standoff;
        if (height > 0.9 * config_.standoff) phase_ = HandPhase::done;
      }
      break;
    case HandPhase::done:
      break;
  }
}

bool HandScript::gives_way(double felt, double height) noexcept {
  held_ = held_ || (felt > 0.5 * goal_.thrust && seconds_since(drive_tick_) > kEngages);
  if (held_ && advance_ > std::max(config_.give_speed, config_.give_ratio * usual_))
    return fast_from_ - height > config_.give_distance && felt < config_.give_force * usual_felt_;
  const double share = std::min(1.0, period_ / kUsualFilter);
  usual_ += (advance_ - usual_) * share;
  usual_felt_ += (felt - usual_felt_) * share;
  fast_from_ = height;
  return false;
}

void HandScript::lean(double felt, double height) noexcept {
  const double ramp = config_.ramp > 0.0 ? std::min(1.0, seconds_since(lean_tick_) / config_.ramp) : 1.0;
  goal_.thrust = config_.push * ramp;
  goal_height_ += (height - goal_height_) * std::min(1.0, period_ / config_.follow_time);
  if (phase_ == HandPhase::lean && gives_way(felt, height)) {
    phase_ = HandPhase::give_felt;
    give_tick_ = tick_;
  }
  const bool reacts = phase_ == HandPhase::give_felt && seconds_since(give_tick_) >= config_.reaction;
  if (!reacts && -height < config_.reach) return;
  phase_ = HandPhase::release;
  release_tick_ = tick_;
  release_thrust_ = goal_.thrust;
}

}  // namespace burrhole
