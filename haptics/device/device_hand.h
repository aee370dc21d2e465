/// haptics/device/device_hand.h: a hand source that reads a force device.
///   Frames device to world by a pose and a scale of lengths; forces back by the pose and a scale of forces.   Units  SI.
///   Errors out_of_range from create() and check().   Thread  servo.
///   A device of 3 to 8 N cannot render the 28 N of a typical thrust. The device gets the force of the drill times force_scale; all other
///   quantities (recorded force, thrust, load of erosion) stay in unscaled newtons. The stiffness at the grip is the world stiffness times
///   position_scale * force_scale; this product must stay below the maximum stable stiffness of the device.
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "haptics/device/haptic_device.h"
#include "haptics/device/simulated_device.h"
#include "haptics/hand/hand_script.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

struct DeviceMap {
  Pose world_from_device{};                 ///< pose of the device frame in the world
  double position_scale = 1.0;              ///< [-] > 0: metres in the world per metre of the grip
  double force_scale = 1.0;                 ///< [-] > 0: newtons at the grip per newton in the world
  Quat grip_from_tool{1.0, 0.0, 0.0, 0.0};  ///< [-] rotation of the drill relative to the grip

  [[nodiscard]] Vec3 world(const Vec3& in_device) const noexcept { return world_from_device * (in_device * position_scale); }
  [[nodiscard]] Vec3 device(const Vec3& in_world) const noexcept { return (world_from_device.inverse() * in_world) / position_scale; }
  [[nodiscard]] Vec3 to_grip(const Vec3& in_world) const noexcept {
    return glm::conjugate(world_from_device.rotation) * in_world * force_scale;
  }
};
/// @returns out_of_range if a scale is not finite or not > 0, or the pose is not finite.
[[nodiscard]] Status check(const DeviceMap& map);
/// @returns the scale that maps `world_force` [N] to the largest force of the device; at most 1.
[[nodiscard]] double fitting_force_scale(const DeviceInfo& device, double world_force) noexcept;

/// Button of the grip with which the hand grasps the bone, in a scene with [motion].
inline constexpr std::uint32_t kGraspButton = 1u << 1;

/// A hand source that reads a device, real or simulated. The phase is always `approach`: the intention of the user is unknown.
class DeviceHand final : public HandSource {
 public:
  /// @pre `device` outlives the hand. Errors as check().
  [[nodiscard]] static Result<DeviceHand> create(HapticDevice& device, const DeviceMap& map);

  /// Reads the device once. If the device is lost: flag kHandLost, and the motion of the last report.
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  /// The device does not report how hard the user pushes. The thrust is the force of the drill along its axis, which is in equilibrium with
  /// it.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] std::uint32_t buttons() const noexcept { return buttons_; }

 private:
  DeviceHand(HapticDevice& device, const DeviceMap& map) : device_(&device), map_(map) {}
  HapticDevice* device_;
  DeviceMap map_;
  std::uint32_t buttons_ = 0;
  HandState state_;
};

/// A simulated device whose grip is moved by the script of the simulated hand. The script receives the force that the device renders,
/// unscaled. Its thrust is scaled as forces are, so the thrust on the drill is that of the scene for every device.
class ScriptedDeviceHand final : public HandSource {
 public:
  /// Places the grip at the start of the script. @pre `device` outlives the hand. Errors as check() and HandScript;
  /// out_of_range if the grip has no spring (moved_by_arm).
  /// @param period [s] servo tick. @param feels false: no force acts on the script and the grip (for comparison).
  [[nodiscard]] static Result<ScriptedDeviceHand> create(SimulatedDevice& device, const DeviceMap& map, const HandScriptConfig& script,
                                                         const Pose& world_from_approach, double period, bool feels = true);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  void drive_changed() noexcept BH_REALTIME override { script_.drive_changed(); }
  void drill_stopped() noexcept BH_REALTIME override { script_.drill_stopped(); }
  void scene_changed(double softest) noexcept override { script_.scene_changed(softest); }
  void bone_ahead(bool left) noexcept BH_REALTIME override { script_.bone_ahead(left); }
  void drill_at(const Vec3& drill) noexcept BH_REALTIME override { script_.drill_at((world_from_approach_.inverse() * drill).z); }
  void watch_drill() noexcept override { script_.watch_drill(); }
  void added_force(const Vec3& force) noexcept BH_REALTIME override {
    if (feels_) script_.added_force((glm::conjugate(world_from_approach_.rotation) * force).z);
  }

 private:
  ScriptedDeviceHand(SimulatedDevice& device, const DeviceHand& hand, const DeviceMap& map, const HandScript& script,
                     const Pose& world_from_approach, bool feels)
      : device_(&device), hand_(hand), map_(map), script_(script), world_from_approach_(world_from_approach), feels_(feels) {}
  /// One tick of the script from the true position of the grip and the rendered force; sets the goal of the grip.
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
