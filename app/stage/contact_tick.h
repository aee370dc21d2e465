/// app/stage/contact_tick.h: one contact tick: runs the contact steps on the newest copy of bone, updates the drill monitor and the running
///   sums of the result.
///   Frame  world.   Units  SI.   Errors  none.   Thread  contact; never waits, never allocates after bind().
#pragma once

#include <atomic>

#include "app/stage/slots.h"
#include "app/stage/step_graph.h"
#include "core/base/hash.h"
#include "core/measure/axis_bone.h"
#include "core/measure/drill_monitor.h"
#include "core/voxel/contact_window.h"
#include "core/voxel/vdb_contact_grids.h"

namespace burrhole {

/// Source of the bone that the contact clock reads: the published window, the paper's grids, or the samples of the approach axis. One of
/// the three is not null.
struct ContactBone {
  SnapshotBuffer<ContactWindow>* window = nullptr;
  const VdbContactGrids* grids = nullptr;
  AxisBone* axis = nullptr;
  Affine bone_from_index;
  Pose world_from_bone;
  const CoarseDistance* coarse = nullptr;  ///< of the whole bone; null: contact knows only the window

  /// @returns the newest copy; valid until the next call. With the axis alone it knows no voxel.
  [[nodiscard]] BoneView view() const;
  /// @returns the number of that copy (ContactWindow::number); 0 for the paper's grids.
  [[nodiscard]] std::uint64_t number() const noexcept;
};

/// Moves the bone: [motion].
class BoneMover {
 public:
  virtual ~BoneMover() = default;
  /// @returns the motion of the bone at the time of `hand`. Called once for each evaluation, before it.
  [[nodiscard]] virtual BoneMotion move(const HandState& hand) noexcept BH_REALTIME = 0;
};

struct ContactTickConfig {
  ContactBone bone;
  double servo_period = 1e-3;    ///< [s] of one tick of the hand
  double contact_period = 1e-3;  ///< [s]
};

class ContactTick {
 public:
  /// `graph` and `approach` must outlive it.
  ContactTick(StepGraph& graph, const Approach& approach, const ContactTickConfig& config);
  /// Provides the slots of the stage. Call after the effects are bound.
  void bind();
  /// Sets the tool's pose; the tool must not be in contact with bone.
  void place(const Pose& world_from_tool) noexcept { state_->world_from_tool = world_from_tool; }
  /// Restores a state after bind(), for a tool change.
  void resume(const ContactState& state) noexcept { *state_ = state; }
  /// As DrillMonitor::start() and bone_grew().
  void bone_starts(std::span<const std::uint8_t> bone) noexcept { monitor_.start(bone); }
  void bone_grew(std::span<const std::uint8_t> bone) noexcept { monitor_.bone_grew(bone); }
  /// Sets the bone's pose from the next evaluation on; see BoneStep::move_bone().
  void move_bone(const Pose& world_from_bone) noexcept { config_.bone.world_from_bone = world_from_bone; }
  /// From the next evaluation on, `mover` determines the bone's pose; it must outlive the run. Null: none.
  void follow(BoneMover* mover) noexcept { mover_ = mover; }
  [[nodiscard]] bool bone_moves() const noexcept { return mover_ != nullptr; }
  /// Replaces the bound of the distance outside the window; null: nothing is known there (labs).
  void know(const CoarseDistance* coarse) noexcept { config_.bone.coarse = coarse; }
  /// Simulates a stalled contact thread (tests and labs): nothing is evaluated, and the last result remains while its age grows. Any
  /// thread.
  void set_stalled(bool stalled) noexcept { stalled_.store(stalled, std::memory_order_relaxed); }
  /// @returns the result for the mailboxes; the reference is valid until the next call.
  const ContactState& operator()(const HandState& hand) noexcept BH_REALTIME;

  [[nodiscard]] const ContactState& state() const noexcept { return *state_; }
  /// Whether bone is left on the planned axis ahead of the tip, and the bone is at rest. Any thread.
  [[nodiscard]] bool bone_ahead() const noexcept { return bone_ahead_.load(std::memory_order_relaxed); }
  [[nodiscard]] const DrillProgress& progress() const noexcept { return monitor_.progress(); }
  /// [N] The latest force, world frame; zero if it does not reach the hand (kHandUnopposed), which then moves as if there were no bone.
  [[nodiscard]] Vec3 felt_force() const noexcept { return opposed_ ? state_->on_hand.force : Vec3(0.0); }
  [[nodiscard]] std::uint64_t hand_tick() const noexcept { return hand_tick_; }  ///< tick of the latest hand motion read
  [[nodiscard]] double time() const noexcept { return time_; }                   ///< [s] time of the motion of the latest result
  [[nodiscard]] std::uint64_t window() const noexcept { return window_; }        ///< number of the latest copy of bone read
  [[nodiscard]] float step_us() const noexcept { return step_us_; }              ///< [us] duration of the steps
  [[nodiscard]] std::uint64_t hash() const noexcept { return hash_.value(); }
  [[nodiscard]] std::uint32_t flags_seen() const noexcept { return flags_seen_; }

 private:
  StepGraph* graph_;
  ContactTickConfig config_;
  DrillMonitor monitor_;
  Touch* touch_ = nullptr;
  ContactState* state_ = nullptr;
  BoneMover* mover_ = nullptr;
  BoneMotion moved_;
  Pose at_rest_;        // world from bone, as the scene places it
  bool owned_ = false;  // [contact] owns the state; otherwise the tool's pose is that of the hand
  Hash64 hash_;
  double time_ = 0.0;
  std::uint64_t hand_tick_ = 0;
  std::uint64_t window_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint32_t flags_seen_ = 0;
  float step_us_ = 0.0f;
  bool opposed_ = true;
  std::atomic<bool> stalled_{false};
  std::atomic<bool> bone_ahead_{false};
};

}  // namespace burrhole
