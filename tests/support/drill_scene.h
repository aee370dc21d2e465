/// tests/support/drill_scene.h: small scenes for tests, put together the way `burrhole drill` does: TOML text, load_scene, Simulation.
///   The bone is a plate of 6 x 6 x 3 mm, its outer face at the origin; the tools are "ball", a sphere of 2 mm (unless said), "pin", a flat
///   cylinder of 2 mm, and "punch", one of 4 mm; all cut all over with 0.1 a revolution. Small, so that a run takes a fraction of a second
///   and stays quick under a sanitizer.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "app/session/recorded_hand.h"

namespace burrhole::test {

/// Keys of [volume] for the plate.
inline constexpr const char* kPlateKeys = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [6.0, 6.0, 6.0]
above_mm = 1.5
thickness_mm = 3.0
hardness = 0.8
)";
/// A piece of skull, all its layers, dura and brain below.
inline constexpr const char* kSkullPatchKeys = R"(source = "phantom:skull_patch"
spacing_mm = 0.25
extent_mm = [8.0, 8.0, 8.0]
above_mm = 1.5
thickness_mm = 5.0
)";
/// A shell of nothing but inner table, 1.7 mm: the thinnest layer that a drill meets in a skull.
inline constexpr const char* kInnerTableKeys = R"(source = "phantom:skull_patch"
spacing_mm = 0.25
extent_mm = [8.0, 8.0, 6.0]
above_mm = 1.5
thickness_mm = 1.7
outer_table_mm = 0.0
inner_table_mm = 1.7
)";

/// A post of 2 x 2 x 4 mm: narrower than the "punch", so that drilling it has no wall and is a problem of one dimension.
inline constexpr const char* kPostKeys = R"(source = "phantom:block"
spacing_mm = 0.25
extent_mm = [6.0, 6.0, 7.0]
above_mm = 1.5
block_mm = [2.0, 2.0, 4.0]
hardness = 0.8
)";

/// Keys of [contact] for the tool held back: an engaged depth of half a millimetre, two voxels, under 20 N.
inline constexpr const char* kHeldKeys = "cutting_N_per_m = 40e3\n";
/// For a penalty model of 20 kN/m a plane.
inline constexpr const char* kPenaltyKeys = "model = \"gradient-plane\"\nstiffness_N_per_m = 20e3\n";

/// What a small scene is made of. A table that is left out is not in the text at all.
struct SmallScene {
  std::string volume = kPlateKeys;
  bool contact = true, erosion = true, spindle = false, record = false, display = false;
  std::string contact_keys = kHeldKeys;
  std::vector<std::string> sets = {};  ///< "table.key=value", applied as --set does
};

/// The scene as a file would hold it, overrides not applied.
[[nodiscard]] std::string scene_text(const SmallScene& scene);
/// Folders of the small tools and of the shipped ones.
[[nodiscard]] SceneContext test_context();
/// Loads from text; a fault fails the test with its message. `file_name` is what messages and sessions call the scene.
[[nodiscard]] LoadedScene load_text(const std::string& text, const std::vector<std::string>& sets,
                                    const std::string& file_name = "small.toml");
[[nodiscard]] LoadedScene load_small(const SmallScene& scene);
/// app/scenes/parietal.toml with overrides, without pictures, and without its clutch unless an override names it.
[[nodiscard]] LoadedScene load_parietal(const std::vector<std::string>& sets);

/// A scene loaded and put together; run() is called by the test.
class DrillRun {
 public:
  explicit DrillRun(LoadedScene loaded, const SimulationOptions& options = {});
  explicit DrillRun(const SmallScene& scene, const SimulationOptions& options = {}) : DrillRun(load_small(scene), options) {}
  /// Runs to the end; an error fails the test.
  DrillRun& run();

  [[nodiscard]] const LoadedScene& loaded() const noexcept { return *loaded_; }
  [[nodiscard]] Simulation& simulation() noexcept { return *simulation_; }
  [[nodiscard]] std::uint64_t voxel_hash() { return simulation_->voxmap().hash(); }
  [[nodiscard]] double voxel() const { return loaded_->bone->bone_from_index().mean_edge(); }  ///< [m]

 private:
  std::unique_ptr<LoadedScene> loaded_;  // the simulation points at its tool
  std::unique_ptr<Simulation> simulation_;
};

/// The scene's own hand, with an eye on every servo tick.
class WatchedHand final : public HandSource {
 public:
  /// `watch` is called before the hand moves.
  WatchedHand(const LoadedScene& loaded, std::function<void()> watch);
  [[nodiscard]] const HandState& read() noexcept override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept override {
    watch_();
    hand_.apply(on_hand);
  }

 private:
  SimulatedHand hand_;
  std::function<void()> watch_;
};

/// Runs with a session at `path`, hashes noted, and closes it: what `burrhole drill` records.
DrillRun& run_recorded(DrillRun& run, const std::string& path);
/// A recorded session whose scene is loaded again and whose steps run again in the recorded order; an error fails the test.
class ReplayRun {
 public:
  explicit ReplayRun(const std::string& path, SimulationOptions options = {});
  [[nodiscard]] DrillRun& run() noexcept { return *run_; }

 private:
  std::unique_ptr<SessionReader> session_;
  std::unique_ptr<RecordedHand> hand_;
  std::unique_ptr<DrillRun> run_;
};
/// One column of the first stream of a session that has it, a value a row; a session or column that is not there fails the test.
[[nodiscard]] std::vector<double> session_column(const std::string& path, const std::string& name);

/// [rev/s] the slowest that the spindle turned; the scene's spin without [spindle].
[[nodiscard]] double slowest_spin(const Simulation& simulation);
/// A count that an effect reports; an effect that is not there, or does not report it, fails the test.
[[nodiscard]] double figure(const Simulation& simulation, const std::string& table, const std::string& name);

/// First moment at which the hand feels more than `force` [N]; -1: never. [s]
[[nodiscard]] double first_contact(const Simulation& simulation, double force = 0.5);
/// Time at which the tip first came to `depth` [m], linear between samples; -1: never. [s]
[[nodiscard]] double time_at_depth(const Simulation& simulation, double depth);

}  // namespace burrhole::test
