/// haptics/device/device_guard.h: RAII owner of an open device. Its destructor writes zero force, also when an exception leaves the scope.
///   Errors  none.   Thread  the owner's, after the servo has ended.
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
