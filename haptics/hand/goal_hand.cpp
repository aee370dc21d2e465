#include "haptics/hand/goal_hand.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

/// @returns the step of a value towards `wanted`: a share of the way, at most `largest`.
double step_to(double wanted, double now, double share, double largest) noexcept {
  return std::clamp((wanted - now) * share, -largest, largest);
}

/// @returns the vector, shortened to `longest` where it is longer.
Vec3 shortened(const Vec3& v, double longest) noexcept {
  const double length = glm::length(v);
  return length > longest ? v * (longest / length) : v;
}

/// @returns the rotation of the shaft about the tip, which leans it by the length of (right, away) in that direction.
Quat rotation_of(double right, double away) noexcept {
  const double angle = std::hypot(right, away);
  return angle > 0.0 ? glm::angleAxis(angle, Vec3(-away / angle, right / angle, 0.0)) : Quat(1.0, 0.0, 0.0, 0.0);
}

bool is_usable(const UserGoal& goal) noexcept {
  return is_finite(goal.place) && std::isfinite(goal.tilt_right) && std::isfinite(goal.tilt_away);
}

}  // namespace

GoalHand::GoalHand(const GoalHandConfig& config, const Pose& world_from_approach, double period, GoalMailbox& goals,
                   const MassSpringDamper& body)
    : config_(config),
      world_from_approach_(world_from_approach),
      period_(period),
      goals_(&goals),
      body_(body),
      share_(1.0 - std::exp(-period / config.smoothing)),
      goal_(0.0, 0.0, config.standoff),
      position_(goal_) {
  goals.publish({.place = goal_});
  state_.world_from_hand = {world_from_approach.rotation, world_from_approach * position_};
  state_.spin = 0.0;
}

Result<GoalHand> GoalHand::create(const GoalHandConfig& config, const Pose& world_from_approach, double period, GoalMailbox& goals) {
  for (const double value : {config.push, config.smoothing, config.speed, config.turn_speed, config.largest_tilt, config.standoff,
                             config.dynamics.stiffness, period})
    if (!(std::isfinite(value) && value > 0.0))
      return Error{ErrorCode::out_of_range, "force, stiffness, speeds, smoothing, tilt and standoff of a user's hand must be above 0", {}};
  if (!(config.largest_tilt < 1.5)) return Error{ErrorCode::out_of_range, "the largest tilt of a user's hand must be below 1.5 rad", {}};
  if (!(std::isfinite(config.run_up) && config.run_up >= 0.0))
    return Error{ErrorCode::out_of_range, "the run-up of a user's drive must be at least 0", {}};
  auto body = MassSpringDamper::create(config.dynamics, period);
  if (!body) return body.error();
  return GoalHand(config, world_from_approach, period, goals, *body);
}

void GoalHand::follow(const UserGoal& wanted) noexcept {
  goal_ += shortened((wanted.place - goal_) * share_, config_.speed * period_);
  // A tilt that the arm cannot make is not asked of it, so both angles are shortened together.
  const double lean = std::hypot(wanted.tilt_right, wanted.tilt_away);
  const double scale = lean > config_.largest_tilt ? config_.largest_tilt / lean : 1.0;
  const double largest = config_.turn_speed * period_;
  tilt_right_ += step_to(wanted.tilt_right * scale, tilt_right_, share_, largest);
  tilt_away_ += step_to(wanted.tilt_away * scale, tilt_away_, share_, largest);
}

void GoalHand::drive(bool spins) noexcept {
  const double wanted = spins ? 1.0 : 0.0;
  state_.spin += config_.run_up > 0.0 ? step_to(wanted, state_.spin, 1.0, period_ / config_.run_up) : wanted - state_.spin;
}

void GoalHand::start_from(const HandState& other) noexcept {
  state_ = other;
  state_.phase = HandPhase::approach;
  position_ = world_from_approach_.inverse() * other.world_from_hand.translation;
  velocity_ = glm::conjugate(world_from_approach_.rotation) * other.velocity;
  goal_ = position_ - Vec3(0.0, 0.0, std::min(other.thrust, config_.push) / config_.dynamics.stiffness);
  tilt_right_ = tilt_away_ = 0.0;
}

void GoalHand::apply(const Wrench& on_hand) noexcept {
  const UserGoal& wanted = goals_->latest();
  if (is_usable(wanted)) follow(wanted);
  drive(wanted.spins);
  const Vec3 felt = glm::conjugate(world_from_approach_.rotation) * on_hand.force;
  const double stiffness = config_.dynamics.stiffness;
  // Beyond the force of the arm, the goal is as far as that force reaches.
  const Vec3 pull = shortened(goal_ - position_, config_.push / stiffness);
  body_.step(position_, velocity_, felt + (position_ + pull) * stiffness);
  state_.tick += 1;
  state_.phase = wanted.ends ? HandPhase::done : HandPhase::approach;
  state_.thrust = std::max(0.0, -pull.z * stiffness);
  state_.world_from_hand = {world_from_approach_.rotation * rotation_of(tilt_right_, tilt_away_), world_from_approach_ * position_};
  state_.velocity = world_from_approach_.rotate(velocity_);
}

}  // namespace burrhole
