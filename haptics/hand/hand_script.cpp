#include "haptics/hand/hand_script.h"

#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kFilter = 0.005;          // [s] time constant of the filtered speed; a voxel that breaks away takes less
constexpr double kPartOfDrop = 1.0 / 3.0;  // [-] the filter passes two thirds of a drop that 0.6 kg catch up with; half of it is the limit
constexpr double kPartOfEngagement = 0.5;  // [-] pores take a third of it
constexpr double kSettles = 0.1;           // [s] about one oscillation of the hand on the coupling
constexpr double kEngages = 0.5;           // [s] after a change of the drive's speed
constexpr double kSmooth = 0.025;          // [s] time constant of the depth by which feed is measured: an oscillation is no advance
constexpr double kPartOfDepth = 0.75;      // [-] of the engaged depth, over which feed is measured: pores take a third of it
constexpr double kLastPart = 0.25;         // [-] of the thrust: below it a release does not show any more whether bone carries it
constexpr double kNothing = 0.1;           // [-] of the force that counts as contact
constexpr double kLeastAdvance = 1.5e-4;   // [m] a bit that slips off a voxel advances by less

/// @param part [-] of the time, 0 to 1. @returns part of the way, with the least jerk [FlashHogan85].
double least_jerk(double part) noexcept { return part * part * part * (10.0 + part * (6.0 * part - 15.0)); }

}  // namespace

HandScript::HandScript(const HandScriptConfig& config, double mass, double period)
    : config_(config), mass_(mass), period_(period), goal_height_(config.standoff) {}

Result<HandScript> HandScript::create(const HandScriptConfig& config, double mass, double period) {
  for (const double value :
       {config.feed, config.push, config.ramp, config.reaction, config.release, config.contact_force, config.reach, config.standoff,
        config.tremor_amplitude, config.tremor_frequency, config.cut_compliance, config.rough_drop, config.softest})
    if (!(std::isfinite(value) && value >= 0.0))
      return Error{ErrorCode::out_of_range, "a value of the hand's script is negative or not finite", {}};
  if (!(config.follow_time > 0.0)) return Error{ErrorCode::out_of_range, "the hand's follow time must be above 0", {}};
  if (!(config.exit_drop > 0.0 && config.exit_drop <= 1.0))
    return Error{ErrorCode::out_of_range, "the share of thrust that bone ceases to carry at its end must be above 0 and at most 1", {}};
  if (config.watches_drill && !(config.cut_compliance > 0.0 && config.exit_drop < 1.0))
    return Error{ErrorCode::out_of_range, "a hand that watches the drill must know the cutting stiffness and its share of the drop", {}};
  if (!(std::isfinite(mass) && mass > 0.0)) return Error{ErrorCode::out_of_range, "the hand's mass must be above 0", {}};
  if (!(std::isfinite(period) && period > 0.0))
    return Error{ErrorCode::out_of_range, "the period of the hand's script must be above 0", {}};
  return HandScript(config, mass, period);
}

void HandScript::scene_changed(double softest) noexcept {
  if (std::isfinite(softest) && softest >= 0.0) config_.softest = softest;
  starts_anew_ = true;
  stopped_ = false;
  drive_changed();
}

void HandScript::watch_drill() noexcept { config_.watches_drill = pushed_ = config_.cut_compliance > 0.0 && config_.exit_drop < 1.0; }

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
  const double change = (-climb - speed_) * std::min(1.0, period_ / kFilter);
  speed_ += change;
  lacks_ = mass_ * change / period_;
  follow(felt - added_, height, climb);
  added_ = 0.0;
  goal_.rest = Vec3(0.0, 0.0, goal_height_) + tremor();
  ++tick_;
  return goal_;
}

void HandScript::follow(double carried, double height, double climb) noexcept {
  switch (phase_) {
    case HandPhase::approach:
      goal_height_ -= config_.feed * period_;
      if (carried > config_.contact_force) {
        phase_ = HandPhase::lean;
        lean_tick_ = tick_;
        lowest_ = height;
      }
      break;
    case HandPhase::lean:
    case HandPhase::give_felt:
      lean(carried, height, climb);
      break;
    case HandPhase::release:
      release(carried, height);
      break;
    case HandPhase::withdraw:
      goal_height_ += 2.0 * config_.feed * period_;
      // The friction of a device may hold the grip below its rest position, which rises until the grip is there.
      if (goal_height_ >= config_.standoff && height > 0.9 * config_.standoff) {
        goal_height_ = config_.standoff;
        phase_ = HandPhase::done;
      }
      break;
    case HandPhase::done:
      break;
  }
}

void HandScript::release(double carried, double height) noexcept {
  // The rest position follows the hand while the thrust falls. If it stopped at once, the springs of arm and drill would eject the bit.
  const double left = config_.release > 0.0 ? 1.0 - seconds_since(release_tick_) / config_.release : 0.0;
  goal_.thrust = release_thrust_ * std::max(0.0, left);
  goal_height_ += (height - goal_height_) * std::min(1.0, period_ / config_.follow_time);
  if (left > kLastPart) carried_ = carried > 0.5 * load();
  if (left > 0.0) return;
  if (!(config_.resumes && gave_ && carried_ && ahead_)) {
    phase_ = HandPhase::withdraw;
    return;
  }
  phase_ = HandPhase::lean;
  lean_tick_ = tick_;
  stopped_ = false;
  starts_anew_ = true;
  drive_changed();
}

bool HandScript::loses_bone(double carried) noexcept {
  const double rough = goal_.thrust < config_.push ? config_.rough_drop : 0.0;
  const double most = std::max(kPartOfDrop * config_.exit_drop * load(), rough);
  if (held_) return config_.detects && (config_.watches_drill ? face_falls(rough) : lacks_ > most);
  const bool steady = (pushed_ || std::abs(lacks_) < most) && carried > 0.5 * load() && seconds_since(drive_tick_) > kEngages;
  steady_ticks_ = steady ? steady_ticks_ + 1 : 0;
  held_ = static_cast<double>(steady_ticks_) * period_ > kSettles;
  return false;
}

void HandScript::watch_face(double carried) noexcept {
  face_ = drill_ + carried * config_.cut_compliance;
  face_before_ = held_ ? face_before_ + (face_ - face_before_) * std::min(1.0, period_ / kSmooth) : face_;
}

/// Where the bit leaves bone, its next face is engaged by the thrust: the face that carries it falls by the engaged depth.
/// @param rough [N] drop of the force that does not count; over the stiffness of the coupling it is a depth.
bool HandScript::face_falls(double rough) const noexcept {
  const double rough_depth = rough * config_.cut_compliance * (1.0 / config_.exit_drop - 1.0);
  return face_before_ - face_ > std::max(kPartOfEngagement * load() * config_.cut_compliance, rough_depth);
}

bool HandScript::feels_nothing(double carried, double height, double climb) noexcept {
  // A hand that a strong damper throws back feels nothing either, nor does it feel an impact before contact has answered.
  if (starts_anew_ || carried > kNothing * config_.contact_force || climb >= 0.0 || height >= lowest_) {
    lowest_ = starts_anew_ ? height : std::min(lowest_, height);
    lowest_tick_ = tick_;
    starts_anew_ = false;
  }
  return config_.detects && height < lowest_ - kLeastAdvance && seconds_since(lowest_tick_) > kFilter;
}

bool HandScript::runs_ahead(double height) noexcept {
  if (!(config_.detects && config_.cut_compliance > 0.0)) return false;
  if (!held_ || goal_.thrust < config_.push) {
    feed_.skip();
    smooth_ = height;
    return false;
  }
  smooth_ += (height - smooth_) * std::min(1.0, period_ / kSmooth);
  return feed_.advance(-smooth_, std::max(kLeastAdvance, kPartOfDepth * load() * config_.cut_compliance), period_) > config_.softest;
}

void HandScript::lean(double carried, double height, double climb) noexcept {
  const double ramp = config_.ramp > 0.0 ? std::min(1.0, seconds_since(lean_tick_) / config_.ramp) : 1.0;
  goal_.thrust = config_.push * least_jerk(ramp);
  goal_height_ += (height - goal_height_) * std::min(1.0, period_ / config_.follow_time);
  if (config_.watches_drill) watch_face(carried);
  const bool lost = loses_bone(carried), ahead = runs_ahead(config_.watches_drill ? face_ : height),
             none = feels_nothing(carried, height, climb);
  if (phase_ == HandPhase::lean && (lost || ahead || none || stopped_)) {
    phase_ = HandPhase::give_felt;
    give_tick_ = tick_;
  }
  const bool reacts = phase_ == HandPhase::give_felt && seconds_since(give_tick_) >= config_.reaction;
  if (!reacts && -height < config_.reach) return;
  phase_ = HandPhase::release;
  gave_ = reacts;
  carried_ = carried > 0.5 * load();
  release_tick_ = tick_;
  release_thrust_ = goal_.thrust;
}

}  // namespace burrhole
