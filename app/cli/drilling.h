/// app/cli/drilling.h: runs a loaded scene and writes its files; shared by drill, explain --measure and replay.
///   Thread  main.   Errors  those of drill() in app/job.
#pragma once

#include <atomic>
#include <string>

#include "app/cli/picture_sink.h"
#include "app/job/summary.h"
#include "app/scene/load.h"

namespace burrhole::cli {

/// True after SIGINT, SIGTERM or SIGHUP, if catch_signals() was called before: runs then end cleanly after the tick.
[[nodiscard]] const std::atomic<bool>& stop_requested();
/// Handles the first SIGINT and SIGTERM by setting stop_requested(); a second one ends the program. Handles each SIGHUP so, unless it is
/// ignored.
void catch_signals();

struct DrillingFiles {
  std::string folder;           ///< empty: nothing is written
  std::string restore_path;     ///< checkpoint to start from; empty: bone as loaded
  std::string gl = "auto";      ///< value of --gl
  std::string shader_folder{};  ///< value of --shader-dir; empty: the built-in shaders
  std::string inputs{};         ///< value of --inputs, a file of timed inputs; empty: none
  std::string video{};          ///< value of --video, a folder or a video file; empty: no film
  int video_fps = 25;           ///< [1/s] frames of the film, of simulated time
};

struct LiveMode {
  bool live = false;              ///< on threads in real time instead of in lockstep
  bool require_realtime = false;  ///< a refused priority is an error
};

/// Runs the scene and writes pictures, session, bone.vdb, summary.json and report.html. @returns the summary; the caller prints errors.
[[nodiscard]] Result<RunSummary> drill_scene(const LoadedScene& loaded, const DrillingFiles& files, bool quiet, const LiveMode& mode = {});

}  // namespace burrhole::cli
