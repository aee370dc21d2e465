/// tests/support/servo_loop.h: a body on the shipped servo step against a wall that is looked at every few ticks, in lockstep order: sense,
///   contact if due, delivery of what is due, act.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

#include "haptics/hand/mass_spring_damper.h"
#include "haptics/servo/servo_step.h"

namespace burrhole::test {

/// Mass, spring and damper held by a hand that also pushes with a constant force; exact over a tick.
class BodyHand final : public HandSource {
 public:
  BodyHand(const MassSpringDamper& body, const Vec3& position, const Vec3& push) : body_(body), push_(push) {
    state_.world_from_hand.translation = position;
  }
  [[nodiscard]] const HandState& read() noexcept override { return state_; }
  void apply(const Wrench& on_hand) noexcept override {
    const Vec3 now = late_ ? before_ : on_hand.force;
    before_ = on_hand.force;
    body_.step(state_.world_from_hand.translation, state_.velocity, now + push_);
    ++state_.tick;
  }
  /// Sabotage: each force comes a tick late.
  void be_late() noexcept { late_ = true; }
  [[nodiscard]] HandState& state() noexcept { return state_; }

 private:
  MassSpringDamper body_;
  Vec3 push_, before_{0.0};
  HandState state_;
  bool late_ = false;
};

/// @tparam Wall callable: ContactState(const HandState& sampled); sample, tick and number are filled in here.
template <class Wall>
class ServoLoop {
 public:
  ServoLoop(const ServoConfig& config, BodyHand hand, Wall wall, int latency = 0)
      : hand_(std::move(hand)),
        wall_(std::move(wall)),
        every_(static_cast<std::uint64_t>(config.multi_rate.contact_ticks)),
        latency_(static_cast<std::uint64_t>(latency)),
        servo_(config, hand_, contact_, hands_) {}

  const ServoOutput& tick() {
    servo_.sense();
    if (tick_ % every_ == 0) {
      const HandState& sampled = hands_.latest();
      ContactState state = wall_(sampled);
      state.world_from_hand = sampled.world_from_hand;
      state.tick = sampled.tick;
      state.number = ++number_;
      if (latency_ == 0)
        contact_.publish(state);
      else
        in_flight_.push_back(state);
    }
    if (!in_flight_.empty() && in_flight_.front().tick + latency_ == tick_) {
      contact_.publish(in_flight_.front());
      in_flight_.pop_front();
    }
    ++tick_;
    return servo_.act();
  }
  [[nodiscard]] BodyHand& hand() noexcept { return hand_; }
  [[nodiscard]] ServoStep& servo() noexcept { return servo_; }

 private:
  BodyHand hand_;
  Wall wall_;
  std::uint64_t every_, latency_, tick_ = 0, number_ = 0;
  std::deque<ContactState> in_flight_;
  TripleBuffer<ContactState> contact_;
  TripleBuffer<HandState> hands_;
  ServoStep servo_;
};

}  // namespace burrhole::test
