/// app/bench/bench_scene.h: the shipped parietal scene, as loaded and drilled to half the thickness of the bone.
///   Frame  world.   Units  SI.   Thread  main.   Errors  those of load_scene(); internal if the run did not end half way.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "app/run/simulation.h"
#include "app/scene/load.h"

namespace burrhole {

/// Loads app/scenes/parietal.toml with overrides ("table.key=value").
[[nodiscard]] Result<std::unique_ptr<LoadedScene>> load_parietal_scene(const std::vector<std::string>& overrides);
/// Loads a scene from its text, with the tools of app/tools. @param name of the text, for messages.
[[nodiscard]] Result<std::unique_ptr<LoadedScene>> load_scene_text(const std::string& text, const std::string& name);
/// Loads a tool file of app/tools. @param erosion_pitch [m].
[[nodiscard]] Result<Tool> load_shipped_tool(const std::string& name, double erosion_pitch);

/// A simulated hand that records its states.
class RecordingHand final : public HandSource {
 public:
  explicit RecordingHand(SimulatedHand hand) : hand_(std::move(hand)) {}
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
  std::unique_ptr<RecordingHand> hand;
  std::unique_ptr<std::atomic<bool>> stop;
  std::unique_ptr<Simulation> simulation;  ///< stopped when the tip was at half the thickness of the bone
};

/// @param quick uses a tool that cuts ten times as fast, for a short run.
[[nodiscard]] Result<DrilledScene> drill_parietal_half_way(bool quick);

}  // namespace burrhole
