/// haptics/device/simulated_device.h: simulation of a force device and the hand that holds it, as one body (plant.h). It models quantised
///   positions, readings delayed by whole ticks, a velocity estimated from positions, and a largest force.
///   Frame  device.   Units  SI.   Errors  out_of_range from create().   Thread  servo.
///   write() advances the time: the force acts for one tick, then the next reading is sampled.
///   Not modelled: legs and joints (quantum, friction and mass are those of the grip, equal everywhere), rotation and torque, end stops of
///   the workspace, vibration of the arm, lag of the amplifier.
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
  double quantum = 0.0;                                            ///< [m] quantum of positions; 0: exact
  double largest_force = std::numeric_limits<double>::infinity();  ///< [N] > 0 of the magnitude; the direction is kept
  double workspace_radius = 0.10;                                  ///< [m] > 0, reported only
  int delay = 0;                                                   ///< [ticks] 0..kMaxReadingDelay, delay of a reading
  /// [s] >= 0 time constant of the first-order low-pass (backward Euler) over differences of reported positions. One quantum of position
  /// appears as a velocity of at most quantum / (period + velocity_time). 0: plain differences.
  double velocity_time = 2e-3;
  bool true_velocity = false;  ///< reports the velocity of the plant instead: for comparison, no real device has it
};

/// @returns the configuration of a device in a hand, with all limits of the device and a reading delay of one tick.
[[nodiscard]] SimulatedDeviceConfig make_simulated_config(const DeviceModel& device, const HandModel& hand) noexcept;

/// Adds the spring and damper of an arm to a device whose hand has no spring, which could not move the grip otherwise. A hand with a
/// spring is not changed. @param arm at the grip: values of the world times force_scale * position_scale.
[[nodiscard]] SimulatedDeviceConfig moved_by_arm(SimulatedDeviceConfig device, const MassSpringDamperConfig& arm) noexcept;

/// Action of the person who holds the grip during a tick.
struct GripGoal {
  Vec3 rest{0.0};    ///< [m] rest position of the hand's spring
  Vec3 thrust{0.0};  ///< [N] in addition to that spring
};

class SimulatedDevice final : public HapticDevice {
 public:
  /// @param period [s] of a tick. @returns out_of_range as Plant, or if a value is outside the range of its comment.
  [[nodiscard]] static Result<SimulatedDevice> create(const SimulatedDeviceConfig& config, double period);

  [[nodiscard]] DeviceInfo info() const noexcept override;
  [[nodiscard]] DeviceReading read() noexcept BH_REALTIME override;
  /// Torque is ignored. A force that is not finite counts as zero.
  void write(const Wrench& on_hand) noexcept BH_REALTIME override;

  /// Places the grip and the rest point of the hand, with a history of readings at this position. The grip continues at `velocity`.
  void place(const Vec3& position, const Vec3& velocity = Vec3(0.0)) noexcept;
  void set_goal(const GripGoal& goal) noexcept BH_REALTIME { goal_ = goal; }
  void set_buttons(std::uint32_t buttons) noexcept { buttons_ = buttons; }
  /// Simulates a disconnected cable, and its reconnection: a lost device repeats its last report and renders no force.
  void set_lost(bool lost) noexcept;

  /// @returns the force [N] that the device renders for a requested force.
  [[nodiscard]] Vec3 shown(const Vec3& force) const noexcept BH_REALTIME;
  [[nodiscard]] const SimulatedDeviceConfig& config() const noexcept { return config_; }
  [[nodiscard]] const PlantState& grip() const noexcept { return grip_; }  ///< the true state, not as reported
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }      ///< [N] rendered during the last tick

 private:
  struct Sample {
    Vec3 position{0.0}, velocity{0.0};  // [m], [m/s]
  };
  SimulatedDevice(const SimulatedDeviceConfig& config, double period, const Plant& plant);
  void sample() noexcept;
  [[nodiscard]] Vec3 reported(const Vec3& position) const noexcept;

  SimulatedDeviceConfig config_;
  double period_;
  Plant plant_;
  PlantState grip_;
  GripGoal goal_;
  Vec3 force_{0.0};
  std::array<Sample, kMaxReadingDelay + 1> samples_;  // of the last ticks, ring buffer
  std::size_t newest_ = 0;
  std::uint32_t buttons_ = 0;
  bool lost_ = false;
  DeviceReading last_;
};

}  // namespace burrhole
