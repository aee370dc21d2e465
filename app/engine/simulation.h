/// app/engine/simulation.h: a scene put together and run in lockstep: servo, contact, bone and frame steps over the same mailboxes as
/// a live run, in a fixed order. The one path that drills: program, tests, benchmarks and labs all run this.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/approach.h"
#include "app/engine/bone_step.h"
#include "app/engine/contact_step.h"
#include "app/engine/drill_monitor.h"
#include "app/engine/frame_step.h"
#include "app/engine/hole_measure.h"
#include "app/engine/scene.h"
#include "app/engine/session.h"
#include "haptics/servo/servo_step.h"

namespace burrhole {

/// What a run takes from outside. Pointers must outlive the simulation.
struct SimulationOptions {
  FrameSink* sink = nullptr;                                        ///< needed when the scene has [display] and pictures are wanted
  HandSource* hand = nullptr;                                       ///< a recorded hand; nothing: the scene's own
  SessionWriter* session = nullptr;                                 ///< opened with session_columns(scene)
  std::string restore_path;                                         ///< checkpoint to start from
  const std::atomic<bool>* stop = nullptr;                          ///< set from a signal handler: end cleanly after this tick
  std::function<void(double time, const DrillProgress&)> progress;  ///< called ten times a simulated second
};

enum class RunEnd { done, duration, stopped };

/// One moment for plots, at contact rate.
struct RunSample {
  double time = 0.0;   ///< [s]
  double force = 0.0;  ///< [N] on the hand
  double depth = 0.0;  ///< [m] of the tip
};

/// What happened when, for people.
struct RunEvent {
  double time = 0.0;  ///< [s]
  std::string kind, text;
};

struct RunTimers {
  StepTimer servo, contact, record;
};

/// Columns of a session row, one row a servo tick: what the tick took (hand) and gave (tool, force, loss), of the effects in the scene only.
[[nodiscard]] std::vector<SessionColumn> session_columns(const Scene& scene);

class Simulation {
 public:
  /// Bone is shared between runs of one scene; tool must outlive the simulation. Issues carry the scene's places.
  [[nodiscard]] static std::unique_ptr<Simulation> create(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                                          const SimulationOptions& options, Issues& issues);
  ~Simulation();

  /// For a session opened after everything else was found sound; before run().
  void set_session(SessionWriter* session) noexcept { options_.session = session; }
  /// Runs to the end of the script, of duration_s, or until stopped. An error (display, session file) ends it; what was done stays.
  [[nodiscard]] Status run();

  [[nodiscard]] RunEnd end() const noexcept { return end_; }
  [[nodiscard]] double time() const noexcept { return static_cast<double>(tick_) * period_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_; }
  [[nodiscard]] const Approach& approach() const noexcept { return approach_; }
  [[nodiscard]] const DrillProgress& progress() const noexcept { return monitor_->progress(); }
  [[nodiscard]] const std::vector<RunSample>& samples() const noexcept { return samples_; }
  [[nodiscard]] const std::vector<RunEvent>& events() const noexcept { return events_; }
  [[nodiscard]] const ContactState& contact_state() const noexcept { return contact_now_; }
  [[nodiscard]] const ServoOutput& servo_output() const noexcept { return servo_now_; }
  [[nodiscard]] std::uint64_t force_hash() const noexcept { return force_hash_.value(); }
  [[nodiscard]] std::optional<std::uint64_t> image_hash() const;
  [[nodiscard]] Voxmap& voxmap() noexcept { return *voxmap_; }
  [[nodiscard]] BoneStep& bone_step() noexcept { return *bone_; }
  [[nodiscard]] RunTimers& timers() noexcept { return timers_; }
  [[nodiscard]] FrameStep* frame_step() noexcept { return frame_ ? &*frame_ : nullptr; }
  [[nodiscard]] std::uint32_t contact_flags() const noexcept { return flags_seen_; }
  [[nodiscard]] std::size_t contact_points() const noexcept { return contact_ ? contact_->points() : 0; }

 private:
  Simulation(const Scene& scene, const Tool& tool, const SimulationOptions& options);
  [[nodiscard]] Status build(std::shared_ptr<const BoneModel> bone);
  void run_contact();
  void run_bone();
  void deliver_due();
  [[nodiscard]] Status after_tick();
  [[nodiscard]] Status record_row();
  [[nodiscard]] Status note(const std::string& kind, const std::string& text);
  [[nodiscard]] Status draw(const std::string& name, bool with_tool, bool cut);
  [[nodiscard]] bool finished();

  Scene scene_;
  const Tool* tool_;
  SimulationOptions options_;
  double period_ = 1e-3;  // [s] of the servo
  std::uint64_t contact_every_ = 1, bone_every_ = 4;
  std::uint64_t latency_ = 1;

  Approach approach_;
  std::unique_ptr<Voxmap> voxmap_;
  std::optional<SimulatedHand> own_hand_;
  TripleBuffer<ContactState> force_mailbox_;  // contact -> servo
  TripleBuffer<HandState> hand_mailbox_;      // servo -> contact
  std::vector<ContactState> in_flight_;       // contact results on their way: ring of latency + 1
  std::unique_ptr<ServoStep> servo_;
  std::optional<ContactStep> contact_;
  std::optional<BoneStep> bone_;
  std::optional<FrameStep> frame_;
  std::optional<DrillMonitor> monitor_;

  std::uint64_t tick_ = 0;
  ContactState contact_now_;
  double thrust_sum_ = 0.0, thrust_ = 0.0;  // [N] cutting force since the last step of bone, and its mean
  int thrust_count_ = 0;
  ServoOutput servo_now_;
  Hash64 force_hash_;
  std::vector<RunSample> samples_;
  std::vector<RunEvent> events_;
  std::vector<double> row_;  // scratch of record_row
  std::uint32_t flags_seen_ = 0;
  HandPhase phase_seen_ = HandPhase::approach;
  bool drew_half_ = false, noted_passing_ = false, drew_breakthrough_ = false;
  RunEnd end_ = RunEnd::done;
  RunTimers timers_;
};

}  // namespace burrhole
