// A whole run behind a state, without window and picture: a monkey with seeds plays a person. The session must replay to the same bits.
#include "app/window/window_state.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "app/session/recorded_hand.h"
#include "core/base/random.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kSeconds = 4.0;  // of a monkey's run
constexpr double kPoll = 0.005;   // [s]

SmallScene scene() { return {.record = true, .sets = {"duration_s=60", "hand={kind=\"mouse\", standoff_mm=0.5, run_up_s=0.1}"}}; }

struct Random {
  std::uint64_t seed, count = 0;
  double uniform() { return uniform01(seed, count++); }
};

struct Outcome {
  std::uint64_t voxels = 0, forces = 0, sent = 0;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};
Outcome outcome_of(DrillRun& run) { return {run.voxel_hash(), run.simulation().force_hash(), run.simulation().sent_hash()}; }

ControlsSetup setup_of(DrillRun& run) {
  ControlsSetup out;
  out.hand = *run.loaded().scene.goal_hand;
  out.world_from_approach = run.simulation().stage().world_from_approach();
  for (const char* name : {"ball", "pin", "punch"}) {
    auto text = read_tool_text(name, "small.toml", test_context());
    REQUIRE(text);
    out.tools.push_back({name, *text});
  }
  return out;
}

/// Any key, button, wheel, drag, loss of focus or resize, but no end: the test ends the run.
WindowEvent any_event(Random& random) {
  const auto pick = [&](int n) { return static_cast<int>(random.uniform() * n); };
  switch (pick(12)) {
    case 0:
      return {.kind = WindowEvent::Kind::button,
              .code = pick(5),
              .down = random.uniform() < 0.5,
              .x = 800 * random.uniform(),
              .y = 600 * random.uniform()};
    case 1:
      return {.kind = WindowEvent::Kind::motion, .x = 1200 * random.uniform() - 200, .y = 900 * random.uniform() - 200};
    case 2:
      return {.kind = WindowEvent::Kind::scroll, .y = 10 * random.uniform() - 5};
    case 3:
      return {.kind = WindowEvent::Kind::focus, .down = random.uniform() < 0.7};
    case 4:
      return {.kind = WindowEvent::Kind::character, .code = pick(70000)};
    default: {
      constexpr int kKeys[] = {32, 32, 32, 87, 87, 87, 83, 65, 68, 81, 69, 262, 263, 264, 265, 340, 341, 80, 80,
                               90, 86, 70, 82, 88, 49, 50, 51, 57, 61, 45, 290, 291, 268, 72,  301, 298, 999};
      return {
          .kind = WindowEvent::Kind::key, .code = kKeys[static_cast<std::size_t>(pick(std::size(kKeys)))], .down = random.uniform() < 0.6};
    }
  }
}

void play(WindowState& state, Random& random, double seconds) {
  PadState pad;
  for (double t = 0.0; t < seconds; t += kPoll) {
    for (int n = 0; n < 3; ++n) state.handle(any_event(random));
    if (random.uniform() < 0.05) pad = {.present = random.uniform() < 0.5, .left_x = random.uniform(), .right_trigger = random.uniform()};
    state.step(kPoll, pad);
    (void)state.view();
    (void)state.take_events();
    if (random.uniform() < 0.1) state.take_mouse(random.uniform() < 0.3);
    std::this_thread::sleep_for(std::chrono::duration<double>(kPoll));
  }
}

}  // namespace

TEST_CASE("state: a monkey at keys, mouse and pad; the run ends cleanly and replays to the same bits") {
  for (const std::uint64_t seed : {1u, 2u}) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "session.sqlite").string();
    WindowState state;
    SimulationOptions options;
    options.live = true;
    options.user = &state;
    options.history = true;
    DrillRun run(scene(), options);
    WindowPlan plan;
    plan.approach = run.simulation().approach();
    state.set_picture_size(800, 600);
    state.begin(plan, setup_of(run), OrbitCamera({}, 0.3, 0.7, 0.08, 0.002), "ball");
    std::thread running([&] { run_recorded(run, path); });
    Random random{seed};
    play(state, random, kSeconds);
    state.handle({.kind = WindowEvent::Kind::close});
    state.step(kPoll, {});
    running.join();
    CHECK(run.simulation().end() == RunEnd::done);
    CHECK(state.view().live.steps > 0);
    const Outcome recorded = outcome_of(run);

    SimulationOptions again;
    again.history = true;
    ReplayRun twin(path, again);
    CHECK(outcome_of(twin.run()) == recorded);
  }
}

TEST_CASE("state: a window that goes while the run is paused ends the run") {
  WindowState state;
  SimulationOptions options;
  options.live = true;
  options.user = &state;
  options.history = true;
  DrillRun run(scene(), options);
  WindowPlan plan;
  plan.approach = run.simulation().approach();
  state.begin(plan, setup_of(run), OrbitCamera({}, 0.3, 0.7, 0.08, 0.002), "ball");
  std::thread running([&] { run.run(); });
  const auto wait = [&](const auto& until) {
    for (int n = 0; n < 4000 && !until(); ++n) {
      state.step(kPoll, {});
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return until();
  };
  CHECK(wait([&] { return state.view().live.time > 0.2; }));
  state.handle({.kind = WindowEvent::Kind::key, .code = static_cast<int>(Key::p), .down = true});
  CHECK(wait([&] { return state.view().paused; }));
  CHECK(wait([&] {  // the clocks stand
    const double at = state.view().live.time;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return state.view().live.time == at;
  }));
  state.handle({.kind = WindowEvent::Kind::close});
  state.step(kPoll, {});
  running.join();
  CHECK(run.simulation().end() == RunEnd::done);
  state.finish(RunSummary{});
  CHECK(state.closed());
}

TEST_CASE("state: time from an event to the picture that shows it is measured once") {
  WindowState state;
  CHECK_FALSE(state.take_latency().has_value());
  state.handle({.kind = WindowEvent::Kind::motion, .x = 1.0, .y = 1.0});
  CHECK_FALSE(state.take_latency().has_value());  // no picture has been begun since
  (void)state.view();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto waited = state.take_latency();
  REQUIRE(waited.has_value());
  CHECK(*waited >= 0.020);
  CHECK_FALSE(state.take_latency().has_value());
}
