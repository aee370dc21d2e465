/// app/run/simulation.h: builds a scene and runs it, in lockstep or live. Program, tests, benchmarks and labs all use it.
///   Frame  world.   Units  SI.   Errors  those of display and session; unavailable for a refused real-time priority.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/run/inputs.h"
#include "app/run/live_replay.h"
#include "app/run/live_rows.h"
#include "app/run/live_run.h"
#include "app/run/lockstep.h"
#include "app/run/run_log.h"
#include "app/scene/scene.h"
#include "app/session/session.h"
#include "app/stage/stage.h"
#include "core/measure/hole_measure.h"

namespace burrhole {

/// What a run takes from outside. Pointers must outlive the simulation.
struct SimulationOptions {
  FrameSink* sink = nullptr;                                          ///< needed when the scene has [display] and pictures are wanted
  HandSource* hand = nullptr;                                         ///< a recorded hand; nothing: the scene's own
  SessionWriter* session = nullptr;                                   ///< opened with session_layout(scene)
  std::string restore_path{};                                         ///< checkpoint to start from
  const std::atomic<bool>* stop = nullptr;                            ///< set from a signal handler: end cleanly after this tick
  std::function<void(double time, const DrillProgress&)> progress{};  ///< called ten times a simulated second
  bool live = false;                                                  ///< on threads against the clock, instead of in lockstep
  bool require_realtime = false;                                      ///< live: a refused priority is an error instead of a warning
  std::function<void(const std::string&)> warn{};                     ///< live: what was refused
  std::vector<Input> inputs{};                                        ///< timed, in order; recorded as they are applied
  bool history = false;                                               ///< undo, reset and checkpoints are possible
};

enum class RunEnd { done, duration, stopped };

/// The timing of a step of the stage or of an effect.
struct TimedStep {
  std::string table;  ///< "hand" and "volume" for the stage's own
  std::string name;
  StepTiming timing;
  bool within_step = false;  ///< part of another row's time
};

class Simulation {
 public:
  /// Bone is shared between runs of one scene; tool must outlive the simulation. Issues carry the scene's places.
  [[nodiscard]] static std::unique_ptr<Simulation> create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                                          const SimulationOptions& options, Issues& issues);
  ~Simulation();

  /// For a session opened after everything else was found sound; before run().
  void set_session(SessionWriter* session);
  /// Runs to the end of the script, of duration_s, or until stopped. An error (display, session file) ends it; what was done stays.
  [[nodiscard]] Status run();

  /// Pictures that a replay drew again, with their hashes.
  [[nodiscard]] const std::vector<SessionStill>& redrawn() const noexcept { return log_->redrawn(); }
  /// Instead of run(): the steps in the order of a session's record; `hand` is the one given in the options.
  [[nodiscard]] Status run_recorded(const SessionReader& session, RecordedHand& hand);

  [[nodiscard]] RunEnd end() const noexcept { return end_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(tick_) * parts_->period; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_; }
  [[nodiscard]] const Approach& approach() const noexcept { return parts_->approach; }
  [[nodiscard]] const DrillProgress& progress() const noexcept { return parts_->contact->progress(); }
  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return log_->samples(); }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return log_->events(); }
  [[nodiscard]] const ContactState& contact_state() const noexcept { return parts_->contact->state(); }
  [[nodiscard]] const ServoOutput& servo_output() const noexcept { return servo_now_; }
  [[nodiscard]] std::uint64_t force_hash() const noexcept { return parts_->contact->hash(); }
  [[nodiscard]] std::optional<std::uint64_t> image_hash() const;
  [[nodiscard]] Voxmap& voxmap() noexcept { return *parts_->voxmap; }
  [[nodiscard]] BoneStep& bone_step() noexcept { return *parts_->bone; }
  [[nodiscard]] FrameStep* frame_step() noexcept { return parts_->frame(); }  ///< null where nothing draws
  [[nodiscard]] Stage& stage() noexcept { return *parts_; }
  [[nodiscard]] const Stage& stage() const noexcept { return *parts_; }
  /// Of the stage, then of the effects in the order of their steps, then of the record.
  [[nodiscard]] std::vector<TimedStep> timings();
  /// One of them by its name; a count of 0 where nothing of that name runs.
  [[nodiscard]] StepTiming timing(std::string_view name);
  /// Of a live run; nothing otherwise.
  [[nodiscard]] const std::optional<LiveReport>& live() const noexcept { return live_; }
  /// Of all forces sent to the hand.
  [[nodiscard]] std::uint64_t sent_hash() const noexcept { return live_ ? live_->force_hash : sent_.value(); }
  [[nodiscard]] std::uint32_t contact_flags() const noexcept { return parts_->contact->flags_seen(); }

 private:
  Simulation(std::unique_ptr<Stage> parts, const SimulationOptions& options);
  [[nodiscard]] Status run_lockstep();
  [[nodiscard]] Status run_on_threads();
  /// Rows of the steps that ran in the last tick.
  [[nodiscard]] Status record_rows(const Lockstep& steps, std::uint64_t window);
  [[nodiscard]] bool finished();
  /// The inputs that are due before a tick, recorded.
  [[nodiscard]] Status apply_inputs(std::uint64_t tick);
  [[nodiscard]] bool input_is_due(std::uint64_t tick) const noexcept;
  /// The next input, recorded as of `tick`.
  [[nodiscard]] Status apply_next(std::uint64_t tick);
  [[nodiscard]] LiveInput live_input(std::uint64_t tick, bool parked, Status& status);
  /// One input, not recorded. What cannot be done (nothing to undo, a checkpoint that is not there) is a warning and an event.
  [[nodiscard]] Status apply(const Input& input);

  std::unique_ptr<Stage> parts_;
  SimulationOptions options_;
  ParcelDesk desk_;
  std::unique_ptr<RunLog> log_;
  std::optional<LiveReport> live_;
  Hash64 sent_;
  std::uint64_t tick_ = 0;
  ServoOutput servo_now_;
  std::vector<double> row_;                   // scratch of record_rows
  std::vector<std::unique_ptr<Tool>> tools_;  // that inputs brought
  std::size_t next_input_ = 0;
  RunEnd end_ = RunEnd::done;
  StepTimer servo_timer_, record_timer_;
};

}  // namespace burrhole
