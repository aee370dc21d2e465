#include "app/engine/contact_tick.h"

#include <chrono>

namespace burrhole {

ContactTick::ContactTick(std::optional<ContactStep> step, const Approach& approach, const ContactTickConfig& config)
    : step_(std::move(step)), config_(config), monitor_(approach) {}

void ContactTick::place(const Pose& world_from_tool) noexcept {
  if (step_) step_->place(world_from_tool);
  state_.world_from_tool = world_from_tool;
}

const ContactState& ContactTick::operator()(const HandState& hand) noexcept {
  using Clock = std::chrono::steady_clock;
  if (stalled_.load(std::memory_order_relaxed)) return state_;
  const BoneView view = config_.bone.view();
  window_ = config_.bone.number();
  const Clock::time_point start = Clock::now();
  const double sum = state_.cutting_sum;
  const std::uint64_t number = state_.number;
  if (step_) {
    state_ = (*step_)(view, hand, config_.contact_period);
  } else {
    state_.world_from_tool = state_.world_from_hand = hand.world_from_hand;
    state_.tick = hand.tick;
  }
  step_us_ = std::chrono::duration<float, std::micro>(Clock::now() - start).count();
  state_.number = number + 1;
  state_.cutting_sum = sum + state_.cutting_force;
  flags_seen_ |= state_.flags;
  hash_.add(state_.on_hand.force);
  hash_.add(state_.on_hand.torque);
  hand_tick_ = hand.tick;
  time_ = static_cast<double>(hand.tick) * config_.servo_period;
  const Vec3 tip = config_.bone.world_from_bone.inverse() * state_.world_from_tool.translation;
  monitor_.look(view.voxels, tip, state_.on_hand.force, state_.engagement, time_);
  return state_;
}

}  // namespace burrhole
