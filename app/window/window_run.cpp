#include "app/window/window_run.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "core/base/units.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;
constexpr double kPoll = 1.0 / 200.0;  // [s] of the main thread: events, goal, held keys

constexpr double kLongestStep = 0.05;  // [s] of a held key, also where the main thread was stalled for longer
constexpr double kBeyondBone = 0.02;   // [m] how far a person can push through: the hands then lie on the bone

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

/// Gives the state and the viewer what a run is about, before its first tick.
void begin(WindowState& state, Viewer& viewer, const LoadedScene& loaded, const WindowRun& run, const Simulation& simulation) {
  const Stage& stage = simulation.stage();
  const DisplayConfig& display = *loaded.scene.find<DisplayConfig>();
  const Pose world_from_approach = stage.world_from_approach();
  const double thickness = stage.approach.thickness;
  ControlsSetup setup;
  if (loaded.scene.goal_hand) setup.hand = *loaded.scene.goal_hand;
  setup.world_from_approach = world_from_approach;
  setup.tools = run.tools;
  setup.deepest = thickness + kBeyondBone;
  WindowPlan plan;
  plan.title = loaded.scene.title;
  plan.approach = stage.approach;
  plan.world_from_bone = loaded.scene.volume.world_from_bone;
  plan.spin_rpm = loaded.scene.tool.spin / kRevPerMinute;
  plan.reference_push = run.demonstration ? 0.0 : run.reference_push;
  plan.largest_push = loaded.scene.goal_hand ? loaded.scene.goal_hand->push : 2.0 * loaded.scene.hand.push;
  plan.demonstration = run.demonstration;
  state.begin(plan, setup, OrbitCamera(world_from_approach, display.azimuth, display.elevation, display.distance, 0.8 * thickness),
              run.tool);
  viewer.set_base(make_frame_view(display, plan.world_from_bone, world_from_approach, thickness, false), stage.tool->turns);
}

/// An exception may not leave the run's thread.
Result<RunSummary> drill_safely(const LoadedScene& loaded, const DrillJob& job) {
  try {
    return drill(loaded, job);
  } catch (const std::exception& error) {
    return Error{ErrorCode::internal, std::string("the run ended with an exception: ") + error.what(), {}};
  }
}

/// What ends a run, and what it has come to.
struct RunSwitches {
  const std::atomic<bool>* signal = nullptr;  // from outside
  std::atomic<bool> stop{false};              // to the run
  std::atomic<bool> finished{false};          // from the run
};

/// Hands events to the state until the run has finished and the window is to go.
void poll(GlfwWindow& window, WindowState& state, const WindowRun& run, RunSwitches& switches) {
  auto before = Steady::now();
  bool full = false, ready = false;
  while (!(state.closed() && switches.finished.load(std::memory_order_acquire))) {
    window.wait(kPoll);
    const auto now = Steady::now();
    state.step(std::min(kLongestStep, std::chrono::duration<double>(now - before).count()), window.pad());
    before = now;
    const WindowView view = state.view_of_controls();
    if (!ready && view.stage == RunStage::drilling) {
      ready = true;
      if (run.job.say) run.job.say("window: ready");
    }
    const bool signalled = switches.signal != nullptr && switches.signal->load(std::memory_order_relaxed);
    // A script does not read the goal by which a person ends a run.
    if (signalled || state.closed() || (run.demonstration && view.goal.ends)) {
      switches.stop = true;
      state.stop_waiting();
    }
    if (signalled && switches.finished.load(std::memory_order_acquire)) state.close();
    if (view.requests.full_screen != full) window.set_full_screen(full = view.requests.full_screen);
  }
}

}  // namespace

bool has_display() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"); }

Result<RunSummary> drill_in_window(const LoadedScene& loaded, WindowRun run) {
  if (loaded.scene.find<DisplayConfig>() == nullptr) return bad_input("a window needs the table [display]", loaded.scene.file);
  auto window = GlfwWindow::create(loaded.scene.title + " - burrhole", run.width, run.height);
  if (!window) return Error{window.error().code, window.error().message + " (--offscreen drills without a window)", {}};
  WindowState state;
  Viewer viewer(*window, state, run.make_sink, run.viewer);
  window->set_handler([&](const WindowEvent& event) { state.handle(event); });

  RunSwitches switches;
  switches.signal = run.job.stop;
  run.job.live = true;
  run.job.stop = &switches.stop;
  run.job.user = &state;
  run.job.make_sink = [&](const DisplayConfig& display, const std::string& folder) { return viewer.make_sink(display, folder); };
  run.job.begin = [&](const Simulation& simulation) { begin(state, viewer, loaded, run, simulation); };

  std::thread drawing([&] { viewer.loop(); });
  std::optional<Result<RunSummary>> summary;
  std::thread running([&] {
    summary.emplace(drill_safely(loaded, run.job));
    if (*summary && !run.job.folder.empty() && loaded.scene.output.report)
      viewer.set_report((std::filesystem::path(run.job.folder) / "report.html").string());
    state.finish(*summary);
    viewer.release();
    switches.finished = true;
  });
  poll(*window, state, run, switches);
  running.join();
  drawing.join();
  if (const auto error = state.error()) return *error;
  if (run.figures) run.figures(viewer.totals());
  return std::move(*summary);
}

}  // namespace burrhole
