/// app/job/drill_job.h: runs a loaded scene and writes all outputs: pictures, session, bone, summary and report.
///   The entry point for the program, tests and clients of the library. Uses no signal handler, no terminal and no OpenGL.
///   Units  SI.   Thread  the caller's; a live run starts its own beside it.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "app/job/picture_sink.h"
#include "app/job/sound_out.h"
#include "app/job/summary.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"

namespace burrhole {

struct DrillJob {
  std::string folder;                       ///< of the outputs; empty: nothing is written
  std::string restore_path;                 ///< checkpoint to start from; empty: bone as loaded
  std::string shipped_scenes;               ///< folder of the shipped scenes, for place_of_scene(); may be empty
  bool live = false;                        ///< true: on threads in real time; false: in lockstep
  bool require_realtime = false;            ///< live: a refused priority is an error
  MakePictureSink make_sink;                ///< for scenes with [display]; empty: no picture is drawn
  MakeSpeaker make_speaker;                 ///< for scenes with [sound]; empty: no sound device
  const std::atomic<bool>* stop = nullptr;  ///< may be set by any thread or signal handler: the run ends cleanly after the tick
  /// Called ten times a simulated second with an estimate of the share of the run that is done, and a text. The share is at least 0; it
  /// exceeds 1 where the tip is deeper than the bone is thick by 5 % or more. May be empty.
  std::function<void(double share, const std::string& text)> progress;
  /// Called at the same times, in lockstep only, between two ticks; may read bone and forces. May be empty.
  std::function<void(Simulation&)> watch;
  /// Called once, before the first tick: approach, hand and bone are there. May be empty.
  std::function<void(const Simulation&)> begin;
  LiveUser* user = nullptr;  ///< a person at a live run (app/run/live_user.h); null: none
  double film_hz = 0.0;      ///< [Hz] frames that the sink gets by film(), in lockstep only; divides the servo rate; 0: none
  std::function<void(const std::string&)> say;   ///< receives the renderer's name, one line; may be empty
  std::function<void(const std::string&)> warn;  ///< receives one line per warning; may be empty
  std::vector<Input> inputs;                     ///< in order of time, with the texts of their tools; see load_inputs()
  std::string created;                           ///< ISO 8601, for the session; empty: now
};

/// Reads timed inputs (app/run/inputs.h) and the texts of the tools that they name. @returns nothing when any issue was pushed.
[[nodiscard]] std::optional<std::vector<Input>> load_inputs(const std::string& path, const Scene& scene, const SceneContext& context,
                                                            Issues& issues);

/// @returns the tools that inputs change to, each once.
[[nodiscard]] InputTools tools_of(const std::vector<Input>& inputs);

/// The message of a run that was stopped before its first tick; it writes nothing.
inline constexpr const char* kNeverBegan = "the run was stopped before it began: nothing was written";

/// Runs the scene and writes summary.json and, unless the scene turns them off, pictures, the session, bone.vdb and report.html. Scene,
/// tools and inputs are checked before the first file is written.
/// Errors: those of the scene's effects; unavailable with kNeverBegan, or for a refused priority; bad_input for a folder or file that cannot
/// be written. After an error of the sound file or of an exported bone all other results are written.
[[nodiscard]] Result<RunSummary> drill(const LoadedScene& loaded, const DrillJob& job);

}  // namespace burrhole
