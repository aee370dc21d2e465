#include "haptics/device/device_hand.h"
#include "haptics/hand/bone_drive.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

Status check(const DeviceMap& map) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(map.position_scale)) return Error{ErrorCode::out_of_range, "the device's position scale must be above 0", {}};
  if (!positive(map.force_scale)) return Error{ErrorCode::out_of_range, "the device's force scale must be above 0", {}};
  const auto turns = [](const Quat& q) { return std::abs(glm::dot(q, q) - 1.0) < 1e-9; };
  if (!(is_finite(map.world_from_device.translation) && turns(map.world_from_device.rotation) && turns(map.grip_from_tool)))
    return Error{ErrorCode::out_of_range, "the device's pose must be finite and its rotations of length 1", {}};
  return {};
}

double fitting_force_scale(const DeviceInfo& device, double world_force) noexcept {
  return world_force > device.largest_force ? device.largest_force / world_force : 1.0;
}

Result<DeviceHand> DeviceHand::create(HapticDevice& device, const DeviceMap& map) {
  if (Status sound = check(map); !sound) return sound.error();
  return DeviceHand(device, map);
}

const HandState& DeviceHand::read() noexcept {
  const DeviceReading reading = device_->read();
  const Pose& grip = reading.device_from_grip;
  state_.world_from_hand = {map_.world_from_device.rotation * grip.rotation * map_.grip_from_tool, map_.world(grip.translation)};
  state_.velocity = map_.world_from_device.rotate(reading.velocity) * map_.position_scale;
  state_.flags = reading.lost ? kHandLost : 0u;
  buttons_ = reading.buttons;
  state_.switches = (buttons_ & kGraspButton) != 0 ? BoneSwitch::kGrasp : 0u;
  return state_;
}

void DeviceHand::apply(const Wrench& on_hand) noexcept {
  device_->write({map_.to_grip(on_hand.force), map_.to_grip(on_hand.torque)});
  const Vec3 up = state_.world_from_hand.rotate({0.0, 0.0, 1.0});
  state_.thrust = std::max(0.0, glm::dot(on_hand.force, up));
  ++state_.tick;
}

Result<ScriptedDeviceHand> ScriptedDeviceHand::create(SimulatedDevice& device, const DeviceMap& map, const HandScriptConfig& script,
                                                      const Pose& world_from_approach, double period, bool feels) {
  auto hand = DeviceHand::create(device, map);
  if (!hand) return hand.error();
  const MassSpringDamperConfig& body = device.config().plant.body;
  if (!(body.stiffness > 0.0)) return Error{ErrorCode::out_of_range, "the script moves the grip by a spring, whose stiffness is 0", {}};
  auto steps = HandScript::create(script, body.mass / (map.force_scale * map.position_scale), period);
  if (!steps) return steps.error();
  device.place(map.device(world_from_approach * Vec3(0.0, 0.0, script.standoff)));
  return ScriptedDeviceHand(device, *hand, map, *steps, world_from_approach, feels);
}

const HandState& ScriptedDeviceHand::read() noexcept {
  state_ = hand_.read();
  state_.phase = script_.phase();
  state_.thrust = thrust_;
  return state_;
}

void ScriptedDeviceHand::follow_script(const Vec3& felt) noexcept {
  const Quat approach_from_world = glm::conjugate(world_from_approach_.rotation);
  const Vec3 shown = map_.world_from_device.rotate(device_->shown(map_.to_grip(felt))) / map_.force_scale;
  const PlantState& grip = device_->grip();
  const Vec3 at = world_from_approach_.inverse() * map_.world(grip.position);
  const Vec3 moves = approach_from_world * map_.world_from_device.rotate(grip.velocity) * map_.position_scale;
  const HandGoal& goal = script_.advance((approach_from_world * shown).z, at.z, moves.z);
  thrust_ = goal.thrust;
  const Vec3 thrust = map_.to_grip(world_from_approach_.rotate({0.0, 0.0, -goal.thrust}));
  device_->set_goal({map_.device(world_from_approach_ * goal.rest), thrust});
}

void ScriptedDeviceHand::apply(const Wrench& on_hand) noexcept {
  const Wrench felt = feels_ ? on_hand : Wrench{};
  follow_script(felt.force);
  hand_.apply(felt);
}

}  // namespace burrhole
