/// app/lab/stability_hand.h: a simulated device in a hand that follows a path, with disturbances between device and servo.
///   Frames as haptics/device/device_hand.h; the path is in the approach frame.   Units SI.   Errors  of device and map.   Thread one.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/lab/stability_case.h"
#include "haptics/device/device_hand.h"
#include "haptics/device/simulated_device.h"

namespace burrhole {

class StabilityHand final : public HandSource {
 public:
  struct Setup {
    SimulatedDeviceConfig device;
    DeviceMap map;
    Pose world_from_approach;
    double period = 1e-3;  ///< [s]
  };
  /// @pre `of` outlives the hand. Errors of device and map are returned.
  [[nodiscard]] static Result<std::unique_ptr<StabilityHand>> create(const Setup& setup, const StabilityCase& of, bool sabotaged);

  [[nodiscard]] const HandState& read() noexcept override;
  void apply(const Wrench& on_hand) noexcept override;

  /// Call before the tick at this time: applies teleports.
  void begin_tick(double time) noexcept;
  [[nodiscard]] const PlantState& grip() const noexcept { return device_.grip(); }
  [[nodiscard]] const Vec3& shown() const noexcept { return device_.force(); }  ///< [N] during the last tick
  [[nodiscard]] const Vec3& felt() const noexcept { return felt_; }             ///< [N] world: force of the last apply(), after sabotage
  /// Positions of the grip at the start of each additional tick without the servo, during the last apply().
  [[nodiscard]] std::span<const PlantState> left_alone() const noexcept { return alone_; }
  [[nodiscard]] const DeviceMap& map() const noexcept { return setup_.map; }
  /// @returns the true position [m] of the grip, world.
  [[nodiscard]] Vec3 world_grip() const noexcept { return setup_.map.world(device_.grip().position); }

 private:
  StabilityHand(const Setup& setup, SimulatedDevice device, const StabilityCase& of, bool sabotaged);
  [[nodiscard]] Vec3 goal(double time) const noexcept;
  [[nodiscard]] int ticks_until_next() noexcept;
  [[nodiscard]] Wrench broken(const Wrench& wrench) noexcept;
  [[nodiscard]] Vec3 grip_of(const Vec3& in_approach) const noexcept { return setup_.map.device(setup_.world_from_approach * in_approach); }

  Setup setup_;
  SimulatedDevice device_;
  std::optional<DeviceHand> hand_;
  const StabilityCase* case_;
  bool sabotaged_;
  double time_ = 0.0;  // [s] time of the servo
  std::uint64_t tick_ = 0;
  std::deque<Wrench> late_;
  Wrench strongest_;
  Vec3 felt_{0.0};
  std::vector<PlantState> alone_;
  HandState reported_;
};

}  // namespace burrhole
