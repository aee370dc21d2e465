#include "app/window/window_run.h"

#include <cstdlib>
#include <filesystem>
#include <thread>

#include "app/job/provenance.h"
#include "app/run/start_thread.h"
#include "app/window/window_loop.h"
#include "core/base/caught_error.h"

namespace burrhole {
namespace {

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

/// An exception may not leave the run's thread.
Result<RunSummary> drill_safely(const LoadedScene& loaded, const DrillJob& job) {
  try {
    return drill(loaded, job);
  } catch (...) {
    return caught_error();
  }
}

}  // namespace

bool has_display() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"); }

Result<RunSummary> drill_in_window(const LoadedScene& loaded, WindowRun run) {
  if (loaded.scene.find<DisplayConfig>() == nullptr) return bad_input("a window needs the table [display]", loaded.scene.file);
  auto window = GlfwWindow::create(run_title(loaded) + " - burrhole", run.width, run.height, wants_quad(loaded));
  if (!window) return Error{window.error().code, window.error().message + " (--offscreen drills without a window)", {}};
  WindowState state;
  Viewer viewer(*window, state, run.make_sink, run.viewer);
  window->set_handler([&](const WindowEvent& event) { state.handle(event); });

  RunSwitches switches;
  switches.signal = run.job.stop;
  run.start.text_scale = run.viewer.text_scale;
  run.job.live = true;
  run.job.stop = &switches.stop;
  run.job.user = &state;
  run.job.make_sink = [&](const DisplayConfig& display, const std::string& folder) { return viewer.make_sink(display, folder); };
  run.job.begin = [&](const Simulation& simulation) { start_window(state, viewer, loaded, run.start, simulation); };

  std::thread drawing, running;
  if (Status started = start_thread(drawing, [&] { viewer.loop(); }); !started) return started.error();
  std::optional<Result<RunSummary>> summary;
  const Status runs = start_thread(running, [&] {
    summary.emplace(drill_safely(loaded, run.job));
    if (*summary && !run.job.folder.empty() && loaded.scene.output.report)
      viewer.set_report((std::filesystem::path(run.job.folder) / "report.html").string());
    state.finish(*summary);
    viewer.release();
    switches.finished = true;
  });
  if (!runs) return viewer.end_unused(drawing, runs.error());
  // A script does not read the goal by which a person ends a run.
  poll_window(
      *window, state, switches, [&](const WindowView& view) { return run.start.demonstration && !view.goal.takes_over && view.goal.ends; },
      [&] {
        if (run.job.say) run.job.say("window: ready");
      });
  running.join();
  drawing.join();
  if (const auto error = state.error()) return *error;
  if (switches.lost && *summary)
    return Error{ErrorCode::unavailable, "the display was lost; the run was ended, and its results were written", run.job.folder};
  if (run.figures) run.figures(viewer.totals());
  return std::move(*summary);
}

}  // namespace burrhole
