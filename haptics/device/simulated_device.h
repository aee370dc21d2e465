/// haptics/device/simulated_device.h: a force device and the hand that holds it, as one body (plant.h), seen through what a device can tell
///   and show: positions in steps, readings late by whole ticks, a velocity out of them, and no more force than it has.
///   Frame  device.   Units SI.   Thread servo.
///   Time goes on in write(): the force is held for one tick, then the next reading is taken.
///   Not modelled: legs and joints (steps, friction and mass are those of the grip, the same everywhere), rotation and torque, stops at the
///   end of the workspace, vibration of the arm, the amplifier's own lag.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "core/base/result.h"
#include "haptics/device/device_model.h"
#include "haptics/device/haptic_device.h"
#include "haptics/device/plant.h"

namespace burrhole {

inline constexpr int kMaxReadingDelay = 31;  // [ticks]

struct SimulatedDeviceConfig {
  std::string_view name = "generic";
  PlantConfig plant;
  double quantum = 0.0;                                            ///< [m] step of positions; 0: exact
  double largest_force = std::numeric_limits<double>::infinity();  ///< [N] > 0 of the magnitude, direction kept
  double workspace_radius = 0.10;                                  ///< [m] > 0, told only
  int delay = 0;                                                   ///< [ticks] 0..kMaxReadingDelay, by which a reading is late
  /// [s] >= 0 of the first-order low-pass (backward Euler) over differences of positions as told: one step of position shows as a speed of
  /// quantum / (period + velocity_time) at most. 0: plain differences.
  double velocity_time = 2e-3;
  bool true_velocity = false;  ///< tells the plant's velocity instead: for comparison, no device knows it
};

/// The device in that hand, one tick late, with all its limits.
[[nodiscard]] SimulatedDeviceConfig make_simulated_config(const DeviceModel& device, const HandModel& hand) noexcept;

/// What the person who holds the grip does during a tick.
struct GripGoal {
  Vec3 rest{0.0};    ///< [m] where the hand's spring is at rest
  Vec3 thrust{0.0};  ///< [N] besides that spring
};

class SimulatedDevice final : public HapticDevice {
 public:
  /// out_of_range as Plant, or when a value is not what its comment says.
  [[nodiscard]] static Result<SimulatedDevice> create(const SimulatedDeviceConfig& config, double period);

  [[nodiscard]] DeviceInfo info() const noexcept override;
  [[nodiscard]] DeviceReading read() noexcept BH_REALTIME override;
  /// Torque is not shown. A force that is not finite is none.
  void write(const Wrench& on_hand) noexcept BH_REALTIME override;

  /// Puts the grip there as if it had always been there; the hand's rest point too. It goes on at that velocity.
  void place(const Vec3& position, const Vec3& velocity = Vec3(0.0)) noexcept;
  void set_goal(const GripGoal& goal) noexcept BH_REALTIME { goal_ = goal; }
  void set_buttons(std::uint32_t buttons) noexcept { buttons_ = buttons; }
  /// As if the cable were pulled, and put back: a lost device tells its last report and shows no force.
  void set_lost(bool lost) noexcept;

  /// What the device can show of a force.
  [[nodiscard]] Vec3 shown(const Vec3& force) const noexcept BH_REALTIME;
  [[nodiscard]] const PlantState& grip() const noexcept { return grip_; }  ///< as it is, not as told
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }      ///< [N] shown during the last tick

 private:
  struct Sample {
    Vec3 position{0.0}, velocity{0.0};
  };
  SimulatedDevice(const SimulatedDeviceConfig& config, double period, const Plant& plant);
  void sample() noexcept;
  [[nodiscard]] Vec3 told(const Vec3& position) const noexcept;

  SimulatedDeviceConfig config_;
  double period_;
  Plant plant_;
  PlantState grip_;
  GripGoal goal_;
  Vec3 force_{0.0};
  std::array<Sample, kMaxReadingDelay + 1> samples_;  // of the last ticks, ring
  std::size_t newest_ = 0;
  std::uint32_t buttons_ = 0;
  bool lost_ = false;
  DeviceReading last_;
};

}  // namespace burrhole
