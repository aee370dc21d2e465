/// app/cli/drill_window.h: commands in a window: `burrhole drill`, where a person drills, and `burrhole replay --view`.
///   Thread  main.   Errors  unavailable: no display, no OpenGL, or a build without window; those of drill() in app/job.
#pragma once

#include <string>

#include "app/cli/commands.h"
#include "app/cli/drilling.h"

namespace burrhole::cli {

/// What the options say of a window.
struct WindowOptions {
  bool asked = false;           ///< --window: without a window the command fails
  bool demonstration = false;   ///< --demo: the scene's own hand drills
  bool light = false;           ///< --light
  double text_scale = 1.0;      ///< [-] --text-scale
  double reference_push = 0.0;  ///< [N] of the scene's script; set by prepare_window()
};

/// Adds --light and --text-scale.
void add_view_options(CLI::App& command, WindowOptions& options);
/// Adds those, --window and --demo.
void add_window_options(CLI::App& command, WindowOptions& options);
/// Decides whether the run is in a window, and if so replaces the scene's hand by that of a person, before the scene is loaded. A window
/// opens by default where there is a display, and a scene with [display], a script for a hand and no [device].
[[nodiscard]] Result<bool> prepare_window(WindowOptions& options, SceneOption& scene, bool quiet);
[[nodiscard]] Result<RunSummary> drill_scene_in_window(const LoadedScene& loaded, const WindowOptions& options, const DrillingFiles& files,
                                                       bool quiet);
/// What came of showing a session.
enum class ViewedSession {
  shown,            ///< to its end with the results of the run, or until the person closed the window before
  different,        ///< to its end, with other results
  without_results,  ///< the run was cut short, so nothing can be compared
  lacking_rows      ///< not shown: rows of the run were lost, so its steps cannot be repeated
};
/// Shows a recorded session until the person closes the window. bad_input: the session has no order of steps, or its scene no [display].
[[nodiscard]] Result<ViewedSession> view_session_in_window(const std::string& session, const WindowOptions& options, bool quiet);

}  // namespace burrhole::cli
