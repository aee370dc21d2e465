/// app/run/simulation.h: builds a scene and runs it, in lockstep or live. Program, tests, benchmarks and labs all use it.
///   Frame  world.   Units  SI.   Thread  the caller's; a live run starts its own beside it.
///   Errors  those of display and session; unavailable for a refused real-time priority.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/run/inputs.h"
#include "app/run/live_replay.h"
#include "app/run/live_rows.h"
#include "app/run/live_run.h"
#include "app/run/live_user.h"
#include "app/run/lockstep.h"
#include "app/run/run_log.h"
#include "app/scene/scene.h"
#include "app/session/session.h"
#include "app/stage/stage.h"
#include "core/measure/hole_measure.h"

namespace burrhole {

/// Inputs and outputs of a run apart from the scene. Pointers must outlive the simulation.
struct SimulationOptions {
  FrameSink* sink = nullptr;                                          ///< draws pictures of a scene with [display]; null: none are drawn
  SoundSink* sound = nullptr;                                         ///< receives the samples of a scene with [sound]; null: none are made
  HandSource* hand = nullptr;                                         ///< a recorded hand; null: the scene's own
  SessionWriter* session = nullptr;                                   ///< created with session_layout(); null: no record
  std::string restore_path{};                                         ///< checkpoint to start from; empty: bone as loaded
  const std::atomic<bool>* stop = nullptr;                            ///< set from a signal handler: the run ends cleanly after the tick
  std::function<void(double time, const DrillProgress&)> progress{};  ///< called ten times a simulated second with the time [s]
  bool live = false;                                                  ///< on threads in real time, instead of in lockstep
  bool require_realtime = false;                                      ///< live: a refused priority is an error instead of a warning
  std::function<void(const std::string&)> warn{};                     ///< receives priority refusals, inputs not possible, servo faults
  std::vector<Input> inputs{};                                        ///< timed, in order; recorded when they are applied
  double film_hz = 0.0;  ///< [Hz] frames of a film, in lockstep and replays; divides servo_hz; 0: no film
  /// A person at a live run, who sees the display and moves a hand of kind "mouse"; null: none. The sink then receives changes of bone while
  /// the run goes on, and no picture is drawn at events.
  LiveUser* user = nullptr;
  /// Called by run_recorded() before each servo tick with its time [s]; the recorded pictures are not drawn then. It may wait, read the
  /// stage, and send changed texels to a sink. Empty: the replay runs at full speed.
  std::function<Status(double time)> watch{};
  bool runs = true;      ///< false: built for a check or a picture, at less time and memory; run() refuses
  bool history = false;  ///< keeps what undo, reset and checkpoints need
  bool samples = true;   ///< keeps force and depth of every contact evaluation, for plots
  /// Begins a file of the bone as it is, for an input `export`. All clocks stand, and the bone was written back. @param time [s]
  /// @param format ending of the file. @returns its name. Empty: no file is written.
  std::function<Result<std::string>(const Voxmap& bone, double time, const std::string& format)> export_bone{};
  double untimed = 0.0;  ///< [s] at the start of a live run that its timers leave out
};

/// What ended a run.
enum class RunEnd {
  done,      ///< the hand's script
  duration,  ///< duration_s of the scene
  stopped    ///< SimulationOptions::stop
};

/// The timing of a step of the stage or of an effect.
struct TimedStep {
  std::string table;  ///< of the effect; "hand" and "volume" for the steps of the stage itself
  std::string name;
  StepTiming timing;
  bool within_step = false;  ///< already included in the time of another step of the same table
  std::string part_of{};     ///< table of another step that includes this time; charged_us() moves it to `table`; empty: none
};

/// @returns the total time [us] of the steps of a table. A duration that two steps include is counted once.
[[nodiscard]] double charged_us(std::span<const TimedStep> steps, std::string_view table) noexcept;

class Simulation {
 public:
  /// @param bone may be shared by several simulations. @param tool must outlive the simulation. @returns null when any issue was pushed;
  /// issues carry places of the scene file.
  [[nodiscard]] static std::unique_ptr<Simulation> create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                                          const SimulationOptions& options, Issues& issues);
  ~Simulation();

  /// Sets the session before run(), for callers that create the file only after create() has succeeded.
  void set_session(SessionWriter* session);
  /// Runs to the end of the script, of duration_s, or until stopped. An error of display or session file ends the run; bone and record keep
  /// their state at that time.
  [[nodiscard]] Status run();

  /// Pictures that a replay has drawn again, with their hashes.
  [[nodiscard]] const std::vector<SessionStill>& redrawn() const noexcept { return log_->redrawn(); }
  /// Instead of run(): runs the steps in the order that a session recorded. @param hand the one given in the options.
  [[nodiscard]] Status run_recorded(const SessionReader& session, RecordedHand& hand);

  [[nodiscard]] RunEnd end() const noexcept { return end_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(tick_) * parts_->period; }  ///< [s] simulated
  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_; }
  [[nodiscard]] const Approach& approach() const noexcept { return parts_->approach; }
  [[nodiscard]] const DrillProgress& progress() const noexcept { return parts_->contact->progress(); }
  /// Force and depth of every contact evaluation; empty unless SimulationOptions::samples.
  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return log_->samples(); }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return log_->events(); }
  [[nodiscard]] const ContactState& contact_state() const noexcept { return parts_->contact->state(); }
  [[nodiscard]] const ServoOutput& servo_output() const noexcept { return servo_now_; }
  /// Hash of the wrench of every contact evaluation, in order.
  [[nodiscard]] std::uint64_t force_hash() const noexcept { return parts_->contact->hash(); }
  /// Hash of all pictures; absent without a display.
  [[nodiscard]] std::optional<std::uint64_t> image_hash() const;
  /// Time and force of each layer of bone on the axis.
  [[nodiscard]] const std::vector<LayerLoad>& layer_loads() const noexcept { return log_->layer_loads(); }
  /// Hash of all samples; empty without sound.
  [[nodiscard]] std::string sound_hash() const;
  [[nodiscard]] Voxmap& voxmap() noexcept { return *parts_->voxmap; }
  [[nodiscard]] BoneStep& bone_step() noexcept { return *parts_->bone; }
  [[nodiscard]] FrameStep* frame_step() noexcept { return parts_->frame(); }  ///< null without a display
  [[nodiscard]] Stage& stage() noexcept { return *parts_; }
  [[nodiscard]] const Stage& stage() const noexcept { return *parts_; }
  /// Timings, in this order: the servo; the effects' steps, clock by clock in execution order; further timers of the effects; with contact,
  /// the computation of forces between two contact results ("planes"); the publication of bone ("publish", or "axis" where only the
  /// approach axis is published).
  [[nodiscard]] std::vector<TimedStep> timings();
  /// @returns one of timings() by its name; a count of 0 if there is none.
  [[nodiscard]] StepTiming timing(std::string_view name);
  /// Report of a live run; nothing otherwise.
  [[nodiscard]] const std::optional<LiveReport>& live() const noexcept { return live_; }
  /// Hash of the forces that the servo sent to the hand at all ticks; compare force_hash().
  [[nodiscard]] std::uint64_t sent_hash() const noexcept { return live_ ? live_->force_hash : sent_.value(); }
  [[nodiscard]] std::uint32_t contact_flags() const noexcept { return parts_->contact->flags_seen(); }

  /// @returns the inputs that were not applied, because the run ended before their time; in order.
  [[nodiscard]] std::span<const Input> inputs_left() const noexcept { return std::span(options_.inputs).subspan(next_input_); }

 private:
  Simulation(std::unique_ptr<Stage> parts, const SimulationOptions& options);
  [[nodiscard]] Status run_lockstep();
  [[nodiscard]] Status run_on_threads();
  /// Records the rows of the steps that ran in the last tick.
  [[nodiscard]] Status record_rows(const Lockstep& steps, std::uint64_t window);
  [[nodiscard]] std::uint64_t film_ticks() const noexcept;  ///< from one frame of the film to the next; 0: no film
  /// Draws the next frame of the film.
  [[nodiscard]] Status film();
  [[nodiscard]] bool finished();
  /// Records and applies the inputs that are due before a tick.
  [[nodiscard]] Status apply_inputs(std::uint64_t tick);
  [[nodiscard]] bool input_is_due(std::uint64_t tick) const noexcept;
  /// Records the next input as of `tick` and applies it.
  [[nodiscard]] Status apply_next(std::uint64_t tick);
  /// Records an input as of its tick and applies it.
  [[nodiscard]] Status record_and_apply(const Input& input);
  /// LiveOptions::inputs.
  [[nodiscard]] LiveInput live_input(std::uint64_t tick, bool parked, Status& status);
  /// Applies one input without recording it. An input that is not possible (nothing to undo, no such checkpoint) is a warning and an event.
  [[nodiscard]] Status apply(const Input& input);
  /// Applies what a person asks for during a pause, until the run is to go on.
  [[nodiscard]] Status pause(std::uint64_t tick);

  std::unique_ptr<Stage> parts_;
  SimulationOptions options_;
  BatchHandOff hand_off_;
  std::unique_ptr<RunLog> log_;
  std::optional<LiveReport> live_;
  Hash64 sent_;
  std::uint64_t tick_ = 0;
  ServoOutput servo_now_;
  std::vector<double> row_;                   // scratch of record_rows()
  std::vector<std::unique_ptr<Tool>> tools_;  // of the input that changed the tool last; while it is changed, also the one before
  std::size_t next_input_ = 0;
  bool has_overview_ = false;  // the scene asks for that picture
  RunEnd end_ = RunEnd::done;
  StepTimer servo_timer_;
};

}  // namespace burrhole
