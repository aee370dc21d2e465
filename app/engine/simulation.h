/// app/engine/simulation.h: a scene put together and run in lockstep: servo, contact, bone and frame steps over the same mailboxes as
/// a live run, in a fixed order. The one path that drills: program, tests, benchmarks and labs all run this.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/drill_parts.h"
#include "app/engine/hole_measure.h"
#include "app/engine/live_replay.h"
#include "app/engine/live_run.h"
#include "app/engine/run_log.h"
#include "app/engine/session.h"

namespace burrhole {

/// What a run takes from outside. Pointers must outlive the simulation.
struct SimulationOptions {
  FrameSink* sink = nullptr;                                          ///< needed when the scene has [display] and pictures are wanted
  HandSource* hand = nullptr;                                         ///< a recorded hand; nothing: the scene's own
  SessionWriter* session = nullptr;                                   ///< opened with session_columns(scene)
  std::string restore_path{};                                         ///< checkpoint to start from
  const std::atomic<bool>* stop = nullptr;                            ///< set from a signal handler: end cleanly after this tick
  std::function<void(double time, const DrillProgress&)> progress{};  ///< called ten times a simulated second
  bool live = false;                                                  ///< on threads against the clock, instead of in lockstep
  bool require_realtime = false;                                      ///< live: a refused priority is an error instead of a warning
  std::function<void(const std::string&)> warn{};                     ///< live: what was refused
};

enum class RunEnd { done, duration, stopped };

struct RunTimers {
  StepTimer servo, contact, record;
};

/// How the session of a run is laid out, lockstep or live.
struct SessionLayout {
  std::vector<SessionColumn> columns;
  std::vector<SessionStream> streams;
};
[[nodiscard]] SessionLayout session_layout(const Scene& scene, bool live);
/// Lockstep: columns of a session row, one row a servo tick: what the tick took (hand) and gave (tool, force, loss), of the effects in the
/// scene only.
[[nodiscard]] std::vector<SessionColumn> session_columns(const Scene& scene);

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

  /// Instead of run(): the steps in the order of a live session's record; `hand` is the one given in the options.
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
  [[nodiscard]] RunTimers& timers() noexcept { return timers_; }
  /// Of a live run; nothing otherwise.
  [[nodiscard]] const std::optional<LiveReport>& live() const noexcept { return live_; }
  /// [N] that the simulated device shows now: after a live run, what that left in the hand. Nothing without [device], or where a hand was
  /// given.
  [[nodiscard]] std::optional<double> shown_force() const noexcept {
    return parts_->device ? std::optional(glm::length(parts_->device->force())) : std::nullopt;
  }
  /// Of all forces sent to the hand.
  [[nodiscard]] std::uint64_t sent_hash() const noexcept { return live_ ? live_->force_hash : sent_.value(); }
  [[nodiscard]] FrameStep* frame_step() noexcept { return parts_->frame ? &*parts_->frame : nullptr; }
  [[nodiscard]] std::uint32_t contact_flags() const noexcept { return parts_->contact->flags_seen(); }
  [[nodiscard]] std::size_t contact_points() const noexcept { return parts_->contact->points(); }

 private:
  Simulation(std::unique_ptr<DrillParts> parts, const SimulationOptions& options);
  [[nodiscard]] Status run_lockstep();
  [[nodiscard]] Status run_on_threads();
  [[nodiscard]] Status record_row();
  [[nodiscard]] bool finished();

  std::unique_ptr<DrillParts> parts_;
  SimulationOptions options_;
  ParcelDesk desk_;
  std::unique_ptr<RunLog> log_;
  std::optional<LiveReport> live_;
  Hash64 sent_;
  std::uint64_t tick_ = 0;
  ServoOutput servo_now_;
  std::vector<double> row_;  // scratch of record_row
  RunEnd end_ = RunEnd::done;
  RunTimers timers_;
};

}  // namespace burrhole
