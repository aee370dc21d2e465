/// app/bench/bench_scene.h: the shipped parietal scene, as loaded and drilled half way by the shipped steps.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "app/scene/load.h"
#include "app/run/simulation.h"

namespace burrhole {

/// app/scenes/parietal.toml with overrides ("table.key=value").
[[nodiscard]] Result<std::unique_ptr<LoadedScene>> load_parietal_scene(const std::vector<std::string>& overrides);
/// A tool file of app/tools. @param erosion_pitch [m].
[[nodiscard]] Result<Tool> load_shipped_tool(const std::string& name, double erosion_pitch);

/// Stands for the scene's own hand and keeps what it did.
class KeepingHand final : public HandSource {
 public:
  explicit KeepingHand(SimulatedHand hand) : hand_(std::move(hand)) {}
  [[nodiscard]] const HandState& read() noexcept override {
    states_.push_back(hand_.read());
    return states_.back();
  }
  void apply(const Wrench& on_hand) noexcept override { hand_.apply(on_hand); }
  [[nodiscard]] const std::vector<HandState>& states() const noexcept { return states_; }

 private:
  SimulatedHand hand_;
  std::vector<HandState> states_;
};

struct DrilledScene {
  std::unique_ptr<LoadedScene> loaded;
  std::unique_ptr<KeepingHand> hand;
  std::unique_ptr<std::atomic<bool>> stop;
  std::unique_ptr<Simulation> simulation;  ///< stopped once the tip was past half the thickness of the bone
};

/// `quick`: a sharper tool, so that the run is short.
[[nodiscard]] Result<DrilledScene> drill_parietal_half_way(bool quick);

}  // namespace burrhole
