/// app/window/window_run.h: a run in a window: a person drills, sees and gets the report.
///   Threads  the caller's, which must be the main thread, polls events; the run, the drawing and the clocks of the run have their own.
///   Errors   unavailable: no display, or no OpenGL 4.5 core; those of drill().
#pragma once

#include <string>
#include <vector>

#include "app/job/drill_job.h"
#include "app/window/viewer.h"
#include "app/window/window_loop.h"

namespace burrhole {

struct WindowRun {
  DrillJob job;  ///< live; the window sets user, sink, begin and stop
  MakeWindowSink make_sink;
  WindowStart start;
  int width = 1280, height = 800;  ///< [pixels] of the window
  ViewerConfig viewer;
  std::function<void(const WindowFigures&)> figures;  ///< receives them at the end; may be empty
};

/// @returns whether a display seems to be there; opening a window may fail all the same.
[[nodiscard]] bool has_display();

/// Opens the window, runs, and returns when the person has closed it. The scene must have [display].
[[nodiscard]] Result<RunSummary> drill_in_window(const LoadedScene& loaded, WindowRun run);

}  // namespace burrhole
