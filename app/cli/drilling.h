/// app/cli/drilling.h: one run from a loaded scene to its files; shared by drill, explain --measure and replay.
#pragma once

#include <atomic>
#include <string>

#include "app/cli/picture_sink.h"
#include "app/scene/load.h"
#include "app/job/summary.h"

namespace burrhole::cli {

/// Set by SIGINT and SIGTERM once catch_signals() was called: runs end cleanly after the tick.
[[nodiscard]] const std::atomic<bool>& stop_requested();
void catch_signals();

struct DrillingFiles {
  std::string folder;           ///< empty: nothing is written
  std::string restore_path;     ///< checkpoint to start from; empty: bone as loaded
  std::string gl = "auto";      ///< word of --gl
  std::string shader_folder{};  ///< of --shader-dir; empty: the shaders as built in
  std::string inputs{};         ///< of --inputs: a file of timed inputs; empty: none
};

/// Against the clock, on threads, instead of in lockstep.
struct LiveAsked {
  bool live = false;
  bool require_realtime = false;
};

/// Runs and writes pictures, session, bone.vdb, summary.json and report.html. @returns the summary; faults are printed by the caller.
[[nodiscard]] Result<RunSummary> drill_scene(const LoadedScene& loaded, const DrillingFiles& files, bool quiet,
                                             const LiveAsked& asked = {});

}  // namespace burrhole::cli
