// The servo path takes no memory and no lock over a whole drilled scene: both are counted while the servo is between reading the hand and
// pushing it.
#include <doctest/doctest.h>

#include <atomic>

#include "tests/support/drill_scene.h"
#include "tests/support/memory_trap.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A run ends once so many were run: a busy machine sleeps through some, and none of those is counted. The bit is slow and the hand feels
/// no give, so that neither ends the run before; on a machine that starves the contact loop a latched fault may.
constexpr std::uint64_t kTicks = 1500;
constexpr std::uint64_t kEnough = 300;  // most of them with bone under the bit: every branch of the step is taken many times

/// Marks the servo's path: from reading the hand until it is pushed, its own step included. Sums up what this thread counted.
class MarkedHand final : public HandSource {
 public:
  MarkedHand(const LoadedScene& loaded, bool sabotage, std::atomic<bool>& enough)
      : hand_(loaded, [] {}), sabotage_(sabotage), enough_(&enough) {}
  const HandState& read() noexcept override {
    set_trap(true);
    ++ticks;
    return hand_.read();
  }
  void apply(const Wrench& on_hand) noexcept override {
    if (sabotage_ && ticks == 100) break_the_rules();
    hand_.apply(on_hand);
    if (ticks == kTicks) *enough_ = true;
    set_trap(false);
    taken = trapped().allocations;
    locked = trapped().locks;
  }
  std::uint64_t ticks = 0, taken = 0, locked = 0;

 private:
  WatchedHand hand_;
  bool sabotage_;
  std::atomic<bool>* enough_;
};

MarkedHand drilled(const std::vector<std::string>& sets, bool live, bool sabotage) {
  SmallScene scene{.sets = {"duration_s=60", "hand.standoff_mm=0.5", "tool.erosion_scale=0.1", "hand.detects=false"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  const LoadedScene loaded = load_small(scene);
  std::atomic<bool> enough{false};
  MarkedHand hand(loaded, sabotage, enough);
  SimulationOptions options;
  options.hand = &hand;
  options.stop = &enough;
  options.live = live;
  DrillRun run(scene, options);
  clear_trap();
  run.run();
  set_trap(false);
  CHECK(run.simulation().bone_step().removed_mass() > 0.0);
  return hand;
}

}  // namespace

TEST_CASE("servo path: no memory and no lock is taken while a hole is drilled on threads, by any scheme") {
  for (const char* scheme : {"planes", "gradient", "hold", "linear"}) {
    CAPTURE(scheme);
    const MarkedHand hand = drilled({std::string("servo.multirate=\"") + scheme + "\"", "contact.rate_hz=200"}, true, false);
    CHECK(hand.ticks >= kEnough);
    CHECK(hand.taken == 0);
    CHECK(hand.locked == 0);
  }
}

TEST_CASE("servo path: with every limit on, too") {
  const MarkedHand hand = drilled({"servo.slew_N_per_s=1000", "servo.soft_start_s=0.2", "servo.energy_mJ=1000",
                                   "servo.passivity_N_s_per_m=5", "servo.relied_on_N_s_per_m=5"},
                                  true, false);
  CHECK(hand.taken == 0);
  CHECK(hand.locked == 0);
}

TEST_CASE("servo path: a single block of memory or lock on it is seen") {
  const MarkedHand sound = drilled({}, true, false), harmed = drilled({}, true, true);
  CHECK(sound.taken == 0);
  CHECK(harmed.taken == 2);
  CHECK(harmed.locked == 1);
}
