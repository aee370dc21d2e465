/// haptics/device/device_guard.h: whoever opens a device holds it by this: however the scope is left, by return or by exception, the last
///   thing that the device is told is zero force.   Thread the owner's, after the servo has ended.
#pragma once

#include <memory>
#include <utility>

#include "haptics/device/haptic_device.h"

namespace burrhole {

class DeviceGuard {
 public:
  explicit DeviceGuard(std::unique_ptr<HapticDevice> device) noexcept : device_(std::move(device)) {}
  ~DeviceGuard() { quiet(); }
  DeviceGuard(DeviceGuard&&) noexcept = default;
  DeviceGuard& operator=(DeviceGuard&& other) noexcept {
    if (this != &other) {
      quiet();
      device_ = std::move(other.device_);
    }
    return *this;
  }

  [[nodiscard]] HapticDevice& operator*() const noexcept { return *device_; }
  [[nodiscard]] HapticDevice* operator->() const noexcept { return device_.get(); }

 private:
  void quiet() noexcept {
    if (device_) device_->write({});
  }
  std::unique_ptr<HapticDevice> device_;
};

}  // namespace burrhole
