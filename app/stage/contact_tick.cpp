#include "app/stage/contact_tick.h"

#include <chrono>

namespace burrhole {

namespace {

const ContactWindow kNoWindow;  // in which no voxel is known

}  // namespace

std::uint64_t ContactBone::number() const noexcept {
  if (grids != nullptr) return 0;
  return window != nullptr ? window->front().number : axis->exchange().front().number;
}

BoneView ContactBone::view() const {
  if (grids != nullptr) return {ContactView(*grids, bone_from_index, world_from_bone), {}, world_from_bone};
  const ContactWindow& copy = window != nullptr ? window->latest() : kNoWindow;
  return {ContactView(copy, bone_from_index, world_from_bone), surface_view(copy, bone_from_index, world_from_bone, coarse),
          world_from_bone, coarse};
}

ContactTick::ContactTick(StepGraph& graph, const Approach& approach, const ContactTickConfig& config)
    : graph_(&graph), config_(config), monitor_(approach), at_rest_(config.bone.world_from_bone) {}

void ContactTick::bind() {
  touch_ = graph_->provide(Clock::contact, slots::kTouch);
  owned_ = graph_->is_written(slots::kContact.name);
  state_ = owned_ ? graph_->written(slots::kContact) : graph_->provide(Clock::contact, slots::kContact);
}

const ContactState& ContactTick::operator()(const HandState& hand) noexcept {
  using Timer = std::chrono::steady_clock;
  ContactState& state = *state_;
  if (stalled_.load(std::memory_order_relaxed)) return state;
  graph_->receive(Clock::contact);
  if (mover_ != nullptr) {
    moved_ = mover_->move(hand);
    config_.bone.world_from_bone = moved_.world_from_rest * at_rest_;
  }
  const BoneView view = config_.bone.view();
  const AxisSamples* const axis = config_.bone.axis != nullptr ? &config_.bone.axis->exchange().latest() : nullptr;
  window_ = config_.bone.number();
  const Timer::time_point start = Timer::now();
  *touch_ = {&view, hand};
  graph_->run_steps(Clock::contact, {ticks_++, config_.contact_period});
  graph_->send(Clock::contact);
  if (!owned_) {
    state.world_from_tool = state.world_from_hand = hand.world_from_hand;
    state.tick = hand.tick;
  }
  step_us_ = std::chrono::duration<float, std::micro>(Timer::now() - start).count();
  if (mover_ != nullptr) state.bone = moved_;
  state.spin = hand.spin;
  state.hand_velocity = hand.velocity;
  ++state.number;
  state.cutting_sum += state.cutting_force;
  state.position_sum +=
      mover_ != nullptr ? state.bone.world_from_rest.inverse() * state.world_from_tool.translation : state.world_from_tool.translation;
  flags_seen_ |= state.flags;
  hash_.add(state.on_hand.force);
  hash_.add(state.on_hand.torque);
  hand_tick_ = hand.tick;
  opposed_ = (hand.flags & kHandUnopposed) == 0;
  time_ = static_cast<double>(hand.tick) * config_.servo_period;
  const Pose bone_from_world = config_.bone.world_from_bone.inverse();
  const Vec3 tip = bone_from_world * state.world_from_tool.translation;
  if (axis != nullptr)
    monitor_.look(*axis, view.voxels.voxel_edge(), tip, time_);
  else
    monitor_.look(view.voxels, tip, bone_from_world.rotate(felt_force()), state.engagement, time_);
  bone_ahead_.store(mover_ == nullptr && !progress().open_axis && !progress().passed_time, std::memory_order_relaxed);
  return state;
}

}  // namespace burrhole
