// The hand of a scene in which effects push it: a drilling force that shakes it, a guidance and the dura that carry a part of its thrust. None of
// that is bone, nor its end, and the exit is detected where it is without.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "app/stage/stage.h"
#include "tests/support/drill_scene.h"
#include "tests/support/scene_hand.h"

namespace burrhole::test {
namespace {

using Sets = std::vector<std::string>;

/// Sabotage: the same hand, which does not know that effects push it, and takes all that it feels for bone.
class UnawareHand final : public HandSource {
 public:
  explicit UnawareHand(const SimulatedHand& hand) : hand_(hand) {}
  [[nodiscard]] const HandState& read() noexcept override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept override { hand_.apply(on_hand); }
  void drive_changed() noexcept override { hand_.drive_changed(); }
  void scene_changed(double softest) noexcept override { hand_.scene_changed(softest); }
  void bone_ahead(bool left) noexcept override { hand_.bone_ahead(left); }
  void drill_at(const Vec3& drill) noexcept override { hand_.drill_at(drill); }

 private:
  SimulatedHand hand_;
};

struct Drilled {
  int falsely = 0;                       ///< number of detected breakthroughs in bone
  double through = 0.0, detected = 0.0;  ///< [s] no bone is left on the axis; the hand detects the exit
  double depth = 0.0;                    ///< [m] of the tip then
};

/// Runs the shipped scene without its clutch, which would end the run without any rule of the hand. @returns what `read` finds in the run.
template <class Read>
auto run_of(const Sets& sets, bool aware, Read&& read) {
  LoadedScene loaded = load_parietal(sets);
  UnawareHand unaware(scene_hand(loaded));
  SimulationOptions options;
  if (!aware) options.hand = &unaware;
  DrillRun run(std::move(loaded), options);
  run.run();
  return read(run.simulation());
}

Drilled found_in(const Simulation& simulation, const Sets& sets, bool aware) {
  REQUIRE(simulation.progress().breakthrough_time);
  Drilled out;
  out.through = *simulation.progress().breakthrough_time;
  for (const RunEvent& event : simulation.events()) {
    if (event.text != "breakthrough detected") continue;
    if (event.time < out.through) ++out.falsely;
    out.detected = event.time;
  }
  REQUIRE(out.detected > out.through);
  const auto& samples = simulation.samples();
  const auto at = std::ranges::lower_bound(samples, out.detected, {}, &RunSample::time);
  REQUIRE(at != samples.end());
  out.depth = at->depth;
  std::string all;
  for (const std::string& set : sets) all += set + " ";
  MESSAGE(all << std::string(aware ? "" : "(unaware)") << ": " << out.falsely << " in bone, through after " << out.through
              << " s, detected " << out.detected - out.through << " s later, " << 1e3 * out.depth << " mm deep, at last "
              << 1e3 * simulation.progress().deepest << " mm");
  return out;
}

Drilled drilled(const Sets& sets, bool aware = true) {
  return run_of(sets, aware, [&](const Simulation& simulation) { return found_in(simulation, sets, aware); });
}

constexpr const char* kDrilling = "vibration.drilling_force={}";
constexpr const char* kGuidance = "zones.guidance.start_mm=1";
constexpr const char* kDura = "dura={}";

/// Where the outer drill leaves bone, the face that carries it falls by the engaged depth, thrust / cutting stiffness: at the same depth of the
/// tip, whatever pushes the hand. The rule acts when half of that is done. Until then the filter, 25 ms, adds what the bit cuts in that time: 5 um
/// at 0.2 mm/s.
constexpr double kLater = 0.5 * 28.0 / 140e3 + 5e-6;  // [m]

}  // namespace

TEST_CASE("hand: a force that shakes it, and forces that carry a part of its thrust, are neither bone nor its end") {
  const Drilled plain = drilled({});
  CHECK(plain.falsely == 0);
  for (const Sets& sets : {Sets{kDrilling}, Sets{kGuidance}, Sets{kDrilling, kGuidance}, Sets{kDura},
                           Sets{"vibration.drilling_force.resistance_N_s_per_m=300"}, Sets{"vibration.source=\"chips\""}}) {
    const Drilled pushed = drilled(sets);
    CHECK(pushed.falsely == 0);
    CHECK(pushed.depth < plain.depth + kLater);
    // Feed is in proportion to the force on bone, so it takes longer to the same depth. Of the 28 N of thrust the guidance carries at most its
    // 2000 N/m over the 1.6 mm from where it starts, and the drilling force less than 1 N in the mean.
    CHECK(pushed.detected - pushed.through < (plain.detected - plain.through) * 28.0 / (28.0 - 4.2) + 0.05);
  }
}

/// @returns the number of detected breakthroughs in the first 18 s, in all of which a perforator is in bone.
int in_bone(Sets sets, bool aware = true) {
  sets.emplace_back("duration_s=18");
  return run_of(sets, aware, [](const Simulation& simulation) {
    return static_cast<int>(std::ranges::count(simulation.events(), "breakthrough detected", &RunEvent::text));
  });
}

TEST_CASE("hand: where [motion] hides from it that bone is left, a force that shakes it does not end the run, nor does bone that moves") {
  // 2 mm along the shaft at 10 mm/s: in the 25 ms of the filter the place of the drill in the world changes by more than its engaged depth.
  constexpr const char* kMoves =
      "motion.key=[{time_s=0},{time_s=6},{time_s=6.2,translation_mm=[0,0,-2]},{time_s=8,translation_mm=[0,0,-2]},{time_s=8.2}]";
  CHECK(in_bone({kDrilling, "motion={}"}) == 0);
  CHECK(in_bone({kDrilling, kMoves}) == 0);
  CHECK(in_bone({kMoves}) == 0);
  // Sabotage: its own acceleration ends the run, that by the force and that by the bone.
  CHECK(in_bone({kDrilling, "motion={}"}, false) == 1);
  CHECK(in_bone({kDrilling, kMoves}, false) == 1);
  CHECK(in_bone({kMoves}, false) == 1);
}

TEST_CASE("hand: one that takes all that it feels for bone stops in the diploe, and detects the exit later") {
  const Drilled plain = drilled({}), shaken = drilled({kDrilling}, false), guided = drilled({kGuidance}, false);
  CHECK(shaken.falsely >= 2);
  CHECK(guided.depth > plain.depth + kLater);
}

}  // namespace burrhole::test
