/// haptics/device/haptic_device.h: a force device as the servo sees it: read once and written once a tick.
///   Frame  device: origin at the middle of the workspace, x right, y up, z out of the device towards the user.   Units SI.
///   Thread servo, but info().   Errors while running are told by the reading, never thrown: a device that is gone is lost.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

struct DeviceInfo {
  std::string_view name{};        ///< as in scenes
  double largest_force = 0.0;     ///< [N] that it can show
  double workspace_radius = 0.0;  ///< [m] about the origin
  bool tells_rotation = false;    ///< false: the grip's rotation is always the device frame's
  bool simulated = false;
};

struct DeviceReading {
  Pose device_from_grip;
  Vec3 velocity{0.0};         ///< [m/s] as the device estimates it
  std::uint32_t buttons = 0;  ///< bit n: button n is held
  bool lost = false;          ///< it does not answer; the rest is of its last report
};

class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  [[nodiscard]] virtual DeviceInfo info() const noexcept = 0;
  [[nodiscard]] virtual DeviceReading read() noexcept BH_REALTIME = 0;
  /// What the hand is to feel from now on, until the next write: [N], [N m] about the grip, device frame. Beyond what the device can show
  /// it is limited there.
  virtual void write(const Wrench& on_hand) noexcept BH_REALTIME = 0;
};

}  // namespace burrhole
