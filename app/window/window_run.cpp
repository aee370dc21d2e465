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

constexpr double kBeyondBone = 0.02;  // [m] how far a person can push through: the hands then lie on the bone

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

/// Hands events to the state until the window is to go.
void poll(GlfwWindow& window, WindowState& state, const std::atomic<bool>* stop, std::atomic<bool>& ended) {
  auto before = Steady::now();
  bool full = false;
  while (!state.closed()) {
    window.wait(kPoll);
    const auto now = Steady::now();
    state.step(std::chrono::duration<double>(now - before).count(), window.pad());
    before = now;
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) {
      ended = true;
      state.stop_waiting();
      if (state.stage() == RunStage::ended) state.close();
    }
    bool wanted = full;
    state.with_controls([&](Controls& controls) { wanted = controls.requests().full_screen; });
    if (wanted != full) window.set_full_screen(full = wanted);
  }
  ended = true;
  state.stop_waiting();
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

  const std::atomic<bool>* const stop = run.job.stop;
  std::atomic<bool> ended{false};
  run.job.live = true;
  run.job.stop = &ended;
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
  });
  poll(*window, state, stop, ended);
  running.join();
  drawing.join();
  if (const auto error = state.error()) return *error;
  if (run.figures) run.figures(viewer.totals());
  return std::move(*summary);
}

}  // namespace burrhole
