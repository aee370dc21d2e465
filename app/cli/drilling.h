/// app/cli/drilling.h: runs a loaded scene and writes its files; shared by drill, explain --measure and replay.
///   Thread  main.   Errors  those of drill() in app/job.
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <string>

#include "app/cli/film.h"
#include "app/cli/picture_sink.h"
#include "app/job/summary.h"
#include "app/scene/load.h"

namespace burrhole::cli {

/// True after SIGINT, SIGTERM or SIGHUP, if catch_signals() was called before: runs then end cleanly after the tick.
[[nodiscard]] const std::atomic<bool>& stop_requested();
/// Handles the first SIGINT and SIGTERM by setting stop_requested(); a second one ends the program. Handles each SIGHUP so, unless it is
/// ignored.
void catch_signals();
/// The same, but further SIGINT and SIGTERM do nothing: for what removes its temporary file by itself, soon.
void catch_all_signals();
/// From now on SIGINT and SIGTERM print one line and end the program with exit code 130: for what has nothing to remove.
void end_at_signals();

struct DrillingFiles {
  std::string folder;           ///< empty: nothing is written
  std::string restore_path;     ///< checkpoint to start from; empty: bone as loaded
  std::string gl = "auto";      ///< value of --gl
  std::string shader_folder{};  ///< value of --shader-dir; empty: the built-in shaders
  std::string inputs{};         ///< value of --inputs, a file of timed inputs; empty: none
  FilmOptions film{};           ///< of --video
};

struct LiveMode {
  bool live = false;              ///< on threads in real time instead of in lockstep
  bool require_realtime = false;  ///< a refused priority is an error
};

/// Runs the scene and writes pictures, session, bone.vdb, summary.json and report.html. @returns the summary; the caller prints errors.
[[nodiscard]] Result<RunSummary> drill_scene(const LoadedScene& loaded, const DrillingFiles& files, bool quiet, const LiveMode& mode = {});

/// Adds `--video` and `--video-fps`. @returns the first.
CLI::Option* add_film_options(CLI::App& command, FilmOptions& film);

}  // namespace burrhole::cli
