#include "haptics/hand/bone_drive.h"

#include "core/base/rotation.h"

namespace burrhole {

Pose BoneDrive::pose_of(const Displacement& total) const noexcept {
  return {total.rotation, config_.pivot + total.translation - total.rotation * config_.pivot};
}

Pose BoneDrive::start() const noexcept { return pose_of(path_.at(0.0)); }

BoneMotion BoneDrive::move(const HandState& hand) noexcept {
  const double dt = started_ ? static_cast<double>(hand.tick - tick_) * config_.period : 0.0;
  const Displacement scripted = path_.at(static_cast<double>(hand.tick) * config_.period);
  if (!started_) now_ = pose_of(scripted);
  const bool grasps = (hand.switches & BoneSwitch::kGrasp) != 0;
  if (grasps && !grasped_) hand_from_rest_ = hand.world_from_hand.inverse() * now_;
  grasped_ = grasps;
  const BoneMotion out = grasps ? by_hand(scripted, hand, dt) : by_switches(scripted, hand.switches, dt);
  now_ = out.world_from_rest;
  hand_before_ = hand.world_from_hand.rotation;
  tick_ = hand.tick;
  started_ = true;
  return out;
}

BoneMotion BoneDrive::by_switches(const Displacement& scripted, std::uint32_t switches, double dt) noexcept {
  Vec3 move(0.0), turn(0.0);
  for (int direction = 0; direction < BoneSwitch::kDirections; ++direction) {
    if ((switches & BoneSwitch::bit(direction)) == 0) continue;
    const int axis = direction / 2;
    (axis < 3 ? move[axis] : turn[axis - 3]) += direction % 2 == 0 ? 1.0 : -1.0;
  }
  const Vec3 velocity = config_.axes * (move * config_.speed), rate = config_.axes * (turn * config_.turn_rate);
  added_translation_ += velocity * dt;
  if (rate != Vec3(0.0)) added_rotation_ = glm::normalize(rotation_of(rate * dt) * added_rotation_);
  const Displacement total{.translation = scripted.translation + added_translation_,
                           .rotation = added_rotation_ * scripted.rotation,
                           .velocity = scripted.velocity + velocity,
                           .angular_velocity = rate + added_rotation_ * scripted.angular_velocity};
  const Vec3 pivot_now = config_.pivot + total.translation;
  return {pose_of(total), total.velocity - glm::cross(total.angular_velocity, pivot_now), total.angular_velocity};
}

BoneMotion BoneDrive::by_hand(const Displacement& scripted, const HandState& hand, double dt) noexcept {
  const Pose pose = hand.world_from_hand * hand_from_rest_;
  added_rotation_ = glm::normalize(pose.rotation * glm::conjugate(scripted.rotation));
  added_translation_ = pose * config_.pivot - config_.pivot - scripted.translation;
  Vec3 rate(0.0);
  if (hand.angular_velocity)
    rate = *hand.angular_velocity;
  else if (dt > 0.0)
    rate = rotation_vector(hand.world_from_hand.rotation * glm::conjugate(hand_before_)) / dt;
  return {pose, hand.velocity - glm::cross(rate, hand.world_from_hand.translation), rate};
}

}  // namespace burrhole
