/// app/engine/contact_tick.h: all that happens at contact rate: the contact step on the newest copy of bone, what is watched along the
/// axis, and the sums that go with the result.
///   Thread contact; never waits, never allocates after its construction.
#pragma once

#include <atomic>
#include <optional>

#include "app/engine/contact_step.h"
#include "app/engine/drill_monitor.h"
#include "core/base/hash.h"

namespace burrhole {

struct ContactTickConfig {
  ContactBone bone;
  double servo_period = 1e-3;    ///< [s] of one tick of the hand
  double contact_period = 1e-3;  ///< [s]
};

class ContactTick {
 public:
  /// `step`: nothing without [contact]: nothing is felt then, and the tool goes where the hand goes. `approach` must outlive it.
  ContactTick(std::optional<ContactStep> step, const Approach& approach, const ContactTickConfig& config);
  void place(const Pose& world_from_tool) noexcept;
  /// Bone lies there from the next evaluation on. The voxels kept round the tool are still those for the scene's own pose.
  void move_bone(const Pose& world_from_bone) noexcept { config_.bone.world_from_bone = world_from_bone; }
  /// A stalled contact thread: nothing is looked at and the last result stays, its age growing (tests and labs).
  /// Any thread.
  void set_stalled(bool stalled) noexcept { stalled_.store(stalled, std::memory_order_relaxed); }
  /// @returns the result for the mailboxes; the reference stays good until the next call.
  const ContactState& operator()(const HandState& hand) noexcept BH_REALTIME;

  [[nodiscard]] const ContactState& state() const noexcept { return state_; }
  [[nodiscard]] const DrillProgress& progress() const noexcept { return monitor_.progress(); }
  [[nodiscard]] std::uint64_t hand_tick() const noexcept { return hand_tick_; }  ///< of the motion that was looked at last
  [[nodiscard]] double time() const noexcept { return time_; }                   ///< [s] of the motion that was answered last
  [[nodiscard]] std::uint64_t window() const noexcept { return window_; }        ///< number of the copy of bone that was read last
  [[nodiscard]] float step_us() const noexcept { return step_us_; }              ///< what the contact step alone took
  [[nodiscard]] std::uint64_t hash() const noexcept { return hash_.value(); }
  [[nodiscard]] std::uint32_t flags_seen() const noexcept { return flags_seen_; }
  [[nodiscard]] std::size_t points() const noexcept { return step_ ? step_->points() : 0; }

 private:
  std::optional<ContactStep> step_;
  ContactTickConfig config_;
  DrillMonitor monitor_;
  ContactState state_;
  Hash64 hash_;
  double time_ = 0.0;
  std::uint64_t hand_tick_ = 0;
  std::uint64_t window_ = 0;
  std::uint32_t flags_seen_ = 0;
  float step_us_ = 0.0f;
  std::atomic<bool> stalled_{false};
};

}  // namespace burrhole
