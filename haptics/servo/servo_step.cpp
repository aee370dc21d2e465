#include "haptics/servo/servo_step.h"

namespace burrhole {

const ServoOutput& ServoStep::operator()() noexcept {
  faults_ &= kServoForceNotFinite;  // all that is latched
  Vec3 force = contact_in_->latest().on_hand.force;
  if (!is_finite(force)) faults_ |= kServoForceNotFinite;
  if ((faults_ & kServoForceNotFinite) != 0) force = Vec3(0.0);
  const double magnitude = glm::length(force);
  if (magnitude > config_.largest_force) {
    force *= config_.largest_force / magnitude;
    faults_ |= kServoForceCapped;
  }
  output_.force = force;
  output_.hand = hand_->step(force);
  output_.faults = faults_;
  hand_out_->publish(output_.hand);
  return output_;
}

}  // namespace burrhole
