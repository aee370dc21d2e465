#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include "core/base/hash.h"
#include "haptics/hand/simulated_hand.h"

using namespace burrhole;

// What the simulated hand does, recorded: drills held by it must not change by a bit. Breakthrough is detected 3 ms after the wall opens.

namespace {

struct Recorded {
  const char* name;
  HandConfig config;
  Pose world_from_approach;
  double period;  ///< [s]
  std::uint64_t opens;
  int ticks;
  const char* hash;                ///< of every state
  std::array<double, 5> half_way;  ///< position, velocity.z and thrust half way: tells what differs when the hash does
};

/// A stiff wall at height 0 that rubs a little sideways and is gone from tick `opens` on; world frame.
Vec3 wall_force(const Recorded& run, const HandState& state) {
  const Vec3 at = run.world_from_approach.inverse() * state.world_from_hand.translation;
  if (state.tick >= run.opens || at.z >= 0.0) return Vec3(0.0);
  return run.world_from_approach.rotate({-300.0 * at.x, -200.0 * at.y, -6000.0 * at.z});
}

void add(Hash64& hash, const HandState& state) {
  hash.add(state.world_from_hand.translation);
  for (const double part : {state.world_from_hand.rotation.w, state.world_from_hand.rotation.x, state.world_from_hand.rotation.y,
                            state.world_from_hand.rotation.z, state.thrust})
    hash.add(part);
  hash.add(state.velocity);
  hash.add(static_cast<std::uint64_t>(state.phase));
  hash.add(state.tick);
}

std::array<Recorded, 5> recorded() {
  std::array<Recorded, 5> runs{};
  const Pose turned{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};
  runs[0] = {"firm grip, as shipped",
             {},
             {},
             1e-3,
             4000,
             9000,
             "3f579d9fef8f25b2",
             {-0x1.e5d08dd77b85ap-21, 0x1.4cd4d85e975f3p-17, -0x1.251ba925e60f2p-5, 0x1.58d9bdcdef8ap-10, 0x0p+0}};
  runs[1] = {"oblique approach",
             {},
             turned,
             1e-3,
             4000,
             9000,
             "4c87d15133323371",
             {0x1.0cea81386edc8p-5, -0x1.6a98b5e7d0be5p-4, 0x1.6ab73e078d194p-3, 0x1.7c8b0d5df5911p-11, 0x0p+0}};
  runs[2] = {"light arm, short ramps, 2 kHz",
             {},
             turned,
             0.5e-3,
             6000,
             16000,
             "450c984b55daa3e8",
             {0x1.8c282685cf43p-5, -0x1.ba2c5e93575f2p-4, 0x1.95213714a3064p-3, 0x1.fe52652d66e6dp-8, 0x0p+0}};
  runs[2].config.dynamics = {0.554, 6.45, 135.0};
  runs[2].config.ramp = 0.0;
  runs[2].config.release = 0.0;
  runs[2].config.seed = 7;
  runs[3] = {"numb",
             {},
             {},
             1e-3,
             4000,
             3000,
             "1a213c6c5f080b9f",
             {-0x1.4c7c5edc176a1p-21, -0x1.1843f40db4a6cp-17, -0x1.23cc8d9e8277cp-8, -0x1.47a2beffc8c8fp-8, 0x0p+0}};
  runs[3].config.feels = false;
  runs[4] = {"no tremor, slow hand",
             {},
             {},
             1e-3,
             5000,
             9000,
             "26f4e2b8ad550643",
             {0x0p+0, 0x0p+0, -0x1.47add022691aep-9, -0x1.d55b0b84p-26, 0x1.ep+3}};
  runs[4].config.tremor_amplitude = 0.0;
  runs[4].config.reaction = 0.4;
  runs[4].config.push = 15.0;
  return runs;
}

/// Hash of every state of the run; the state half way.
std::string hash_of(const Recorded& run, HandState& middle) {
  auto hand = SimulatedHand::create(run.config, run.world_from_approach, run.period);
  REQUIRE(hand.ok());
  Hash64 hash;
  for (int n = 0; n <= run.ticks; ++n) {
    const HandState state = hand->read();
    add(hash, state);
    if (n == run.ticks / 2) middle = state;
    hand->apply({wall_force(run, state), Vec3(0.0)});
  }
  return hash.hex();
}

}  // namespace

TEST_CASE("SimulatedHand: every bit of its motion, thrust and phase is what was recorded") {
  for (Recorded run : recorded()) {
    CAPTURE(std::string(run.name));
    HandState middle;
    CHECK(hash_of(run, middle) == run.hash);
    const Vec3 at = middle.world_from_hand.translation;
    const std::array<double, 5> half_way{at.x, at.y, at.z, middle.velocity.z, middle.thrust};
    for (std::size_t n = 0; n < half_way.size(); ++n) CHECK(half_way[n] == run.half_way[n]);
    run.config.feed *= 1.0 + 0x1p-50;  // sabotage: four units in the last place
    CHECK(hash_of(run, middle) != run.hash);
  }
}
