/// app/job/drill_job.h: one run of a loaded scene with all its outputs: pictures, session, bone, summary and report.
///   What the program, the window, tests and clients of the library call. No signal handler, no terminal, no OpenGL.
///   Thread: the caller's; a live run starts its own beside it.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "app/job/picture_sink.h"
#include "app/job/summary.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"

namespace burrhole {

struct DrillJob {
  std::string folder;                       ///< of the outputs; empty: nothing is written
  std::string restore_path;                 ///< checkpoint to start from; empty: bone as loaded
  bool live = false;                        ///< on threads against the clock instead of in lockstep
  bool require_realtime = false;            ///< live: a refused priority is an error
  MakePictureSink make_sink;                ///< for scenes with [display]; empty: no picture is drawn
  const std::atomic<bool>* stop = nullptr;  ///< set to end cleanly after the tick, from any thread or a signal handler
  /// Ten times a simulated second: share of the run done 0..1, and a text. May be empty.
  std::function<void(double share, const std::string& text)> progress;
  /// As often, in lockstep only: the simulation between two ticks, to read bone and forces. May be empty.
  std::function<void(Simulation&)> watch;
  std::function<void(const std::string&)> say;   ///< what draws, which quality; may be empty
  std::function<void(const std::string&)> warn;  ///< one line each; may be empty
  std::vector<Input> inputs;                     ///< timed, with the texts of their tools; see read_inputs()
  std::string created;                           ///< ISO 8601, for the session; empty: now
};

/// Timed inputs of a file (app/run/inputs.h), the texts of their tools read. @returns nothing when any issue was pushed.
[[nodiscard]] std::optional<std::vector<Input>> load_inputs(const std::string& path, const Scene& scene, const SceneContext& context,
                                                            Issues& issues);

/// Runs the scene and writes pictures, the session, bone.vdb, summary.json and report.html. Everything that can refuse does so before the
/// first file is written. Errors: as the scene's parts, bad_input for a folder that cannot be written, unavailable for a refused priority.
[[nodiscard]] Result<RunSummary> drill(const LoadedScene& loaded, const DrillJob& job);

}  // namespace burrhole
