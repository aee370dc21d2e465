/// haptics/device/device_hand.h: whoever holds the drill, by way of a force device.
///   Frames device -> world by a pose and a scale of lengths; forces back by the pose and a scale of their own.   Units SI.   Thread servo.
///   A device of 3 to 8 N cannot show the 28 N of a real thrust: it is told force_scale of what the drill exerts, and everything else, the
///   force recorded, thrust, what cuts bone, stays in real newtons. The grip then feels world stiffness times position_scale * force_scale,
///   and it is that product which must stay under the device's limit.
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "haptics/device/haptic_device.h"
#include "haptics/device/simulated_device.h"
#include "haptics/hand/hand_script.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

struct DeviceMap {
  Pose world_from_device{};                 ///< where the device frame's origin lies, and how its axes
  double position_scale = 1.0;              ///< [-] > 0: metres in the world for a metre of the grip
  double force_scale = 1.0;                 ///< [-] > 0: newtons at the grip for a newton in the world
  Quat grip_from_tool{1.0, 0.0, 0.0, 0.0};  ///< how the drill lies in the grip

  [[nodiscard]] Vec3 world(const Vec3& in_device) const noexcept { return world_from_device * (in_device * position_scale); }
  [[nodiscard]] Vec3 device(const Vec3& in_world) const noexcept { return (world_from_device.inverse() * in_world) / position_scale; }
  [[nodiscard]] Vec3 to_grip(const Vec3& in_world) const noexcept {
    return glm::conjugate(world_from_device.rotation) * in_world * force_scale;
  }
};
/// out_of_range when a scale is not finite or not above 0, or the pose is not finite.
[[nodiscard]] Status check(const DeviceMap& map);
/// The scale that shows `world_force` [N] as all that the device has; never above 1.
[[nodiscard]] double fitting_force_scale(const DeviceInfo& device, double world_force) noexcept;

/// Whoever sits at a real device, or at one that nobody plays. The phase is always `approach`: what a person means to do is unknown.
class DeviceHand final : public HandSource {
 public:
  /// `device` must outlive it. Errors as check().
  [[nodiscard]] static Result<DeviceHand> create(HapticDevice& device, const DeviceMap& map);

  /// Takes one reading. A lost device: kHandLost, and the motion of the last report.
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  /// A device does not tell how hard it is pushed: thrust is what the drill exerts along its axis, which it is in balance.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] std::uint32_t buttons() const noexcept { return buttons_; }

 private:
  DeviceHand(HapticDevice& device, const DeviceMap& map) : device_(&device), map_(map) {}
  HapticDevice* device_;
  DeviceMap map_;
  std::uint32_t buttons_ = 0;
  HandState state_;
};

/// A simulated device whose grip is moved by the script of the simulated hand. The script feels what the device shows of the force, in real
/// newtons, and its thrust is scaled as forces are: it leans on the drill as the scene says, whatever device lies between.
class ScriptedDeviceHand final : public HandSource {
 public:
  /// Places the grip at the script's start. `device` must outlive it. Errors as check() and HandScript.
  /// @param feels false: the script and the grip feel nothing (for comparison).
  [[nodiscard]] static Result<ScriptedDeviceHand> create(SimulatedDevice& device, const DeviceMap& map, const HandScriptConfig& script,
                                                         const Pose& world_from_approach, double period, bool feels = true);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;

 private:
  ScriptedDeviceHand(SimulatedDevice& device, const DeviceHand& hand, const DeviceMap& map, const HandScript& script,
                     const Pose& world_from_approach, bool feels)
      : device_(&device), hand_(hand), map_(map), script_(script), world_from_approach_(world_from_approach), feels_(feels) {}
  /// One tick of the script from what the grip really does and is shown; told to the grip.
  void follow_script(const Vec3& felt) noexcept;

  SimulatedDevice* device_;
  DeviceHand hand_;
  DeviceMap map_;
  HandScript script_;
  Pose world_from_approach_;
  bool feels_;
  double thrust_ = 0.0;  // [N]
  HandState state_;
};

}  // namespace burrhole
