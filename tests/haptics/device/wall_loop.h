/// tests/haptics/device/wall_loop.h: the shipped servo step between a simulated device and a bilateral wall: what a stability limit is of.
#pragma once

#include <array>
#include <cstddef>

#include "haptics/device/device_hand.h"
#include "haptics/servo/servo_step.h"
#include "tests/support/stability_search.h"

namespace burrhole::test {

struct WallLoopConfig {
  SimulatedDeviceConfig device;
  double period = 1e-3;   ///< [s]
  int contact_delay = 0;  ///< [ticks] between the motion that the servo tells and the force that answers it, 0..7
  DeviceMap map;
};

/// The wall pulls the hand to the world's x = 0 with that stiffness [N/m], both ways. One tick: sense, contact, delivery, act.
class WallLoop {
 public:
  WallLoop(const WallLoopConfig& config, double stiffness, double start, double speed = 0.0)
      : config_(config),
        stiffness_(stiffness),
        device_(SimulatedDevice::create(config.device, config.period).value()),
        hand_(DeviceHand::create(device_, config.map).value()),
        servo_(ServoConfig{.largest_force = 1e12}, hand_, contact_, told_) {
    device_.place({start, 0.0, 0.0}, {speed, 0.0, 0.0});
    device_.set_goal({});
  }

  /// @returns [m] where the grip is after it, in its own metres.
  double tick() {
    const HandState& hand = servo_.sense();
    ContactState found;
    found.world_from_hand = hand.world_from_hand;
    found.on_hand.force.x = -stiffness_ * hand.world_from_hand.translation.x;
    found.tick = hand.tick;
    found.number = hand.tick + 1;
    in_flight_[ticks_ % in_flight_.size()] = found;
    const auto late = static_cast<std::size_t>(config_.contact_delay);
    if (ticks_ >= late) contact_.publish(in_flight_[(ticks_ - late) % in_flight_.size()]);
    ++ticks_;
    servo_.act();
    return device_.grip().position.x;
  }
  [[nodiscard]] const SimulatedDevice& device() const noexcept { return device_; }

 private:
  WallLoopConfig config_;
  double stiffness_;
  SimulatedDevice device_;
  DeviceHand hand_;
  TripleBuffer<ContactState> contact_;
  TripleBuffer<HandState> told_;
  ServoStep servo_;
  std::array<ContactState, 8> in_flight_{};
  std::size_t ticks_ = 0;
};

/// Largest stable stiffness of that loop [N/m of the world's wall]; for linear devices (no step, friction or limit).
[[nodiscard]] inline double largest_wall(const WallLoopConfig& config) {
  return largest_stiffness([&](double stiffness) {
    WallLoop loop(config, stiffness, 1e-3);
    // At 1.002 of the limit the envelope grows by a fifth in 40000 ticks in the slowest of the cases.
    return log_growth([&] { return loop.tick(); }, 40000);
  });
}

}  // namespace burrhole::test
