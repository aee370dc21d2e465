/// tests/app/effect/pressed_plate.h: a hand that is moved as given, whatever it gets, and the forces that it gets of the plate.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"

namespace burrhole::test {

/// A hand on the axis at a depth [m] of the ball's lowest point below the plate's face, which may change with the tick.
class PressingHand final : public HandSource {
 public:
  explicit PressingHand(std::function<double(std::size_t)> depth) : depth_(std::move(depth)) {}
  const HandState& read() noexcept override {
    const std::size_t tick = sent.size();
    state_.world_from_hand.translation.z = -depth_(tick);
    state_.velocity.z = tick == 0 ? 0.0 : state_.world_from_hand.translation.z / 1e-3 + depth_(tick - 1) / 1e-3;
    if (angle) state_.world_from_hand.rotation = glm::angleAxis(angle(tick), Vec3(0.0, 1.0, 0.0));
    state_.tick = tick;
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override {
    sent.push_back(on_hand.force.z);
    if (sent.size() == stop_at) stop();
  }
  std::vector<double> sent;                  // [N] along z, of each tick
  std::function<double(std::size_t)> angle;  // [rad] about y at a tick; empty: upright
  std::size_t stop_at = 0;                   // [ticks] after which stop is called
  std::function<void()> stop;

 private:
  std::function<double(std::size_t)> depth_;
  HandState state_;
};

/// The forces that a hand gets, without damping of the coupling, so that they are stiffness times depth.
inline std::vector<double> sent(const std::vector<std::string>& sets, std::function<double(std::size_t)> depth, std::size_t stop_at = 0) {
  PressingHand hand(std::move(depth));
  SimulationOptions options;
  options.hand = &hand;
  SmallScene scene{.erosion = false,
                   .sets = {"duration_s=0.6", "tool.spin_rpm=0", "contact.coupling_N_s_per_m=0", "contact.latency_ticks=0"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  DrillRun run(scene, options);
  hand.stop_at = stop_at;
  hand.stop = [&] { run.simulation().stage().servo->request_stop(); };
  run.run();
  REQUIRE(hand.sent.size() == 600);
  return hand.sent;
}

}  // namespace burrhole::test
