/// haptics/device/haptic_device.h: interface of a force device to the servo, which reads and writes it once per tick.
///   Frame  device: origin at the middle of the workspace, x right, y up, z out of the device towards the user.   Units  SI.
///   Thread servo, except info().   Errors  not thrown while running: DeviceReading::lost reports a device that does not answer.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

struct DeviceInfo {
  std::string_view name{};        ///< name in scenes
  double largest_force = 0.0;     ///< [N] that it can render
  double workspace_radius = 0.0;  ///< [m] about the origin
  bool reports_rotation = false;  ///< false: the rotation of the grip is always identity in the device frame
  bool simulated = false;
};

struct DeviceReading {
  Pose device_from_grip;
  Vec3 velocity{0.0};         ///< [m/s] as estimated by the device
  std::uint32_t buttons = 0;  ///< bit n: button n is pressed
  bool lost = false;          ///< the device does not answer; the other members are those of its last report
};

class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  [[nodiscard]] virtual DeviceInfo info() const noexcept = 0;
  [[nodiscard]] virtual DeviceReading read() noexcept BH_REALTIME = 0;
  /// Sets the force on the hand until the next write: [N], [N m] about the grip, device frame. The device limits it to its largest force.
  virtual void write(const Wrench& on_hand) noexcept BH_REALTIME = 0;
};

}  // namespace burrhole
