/// app/engine/drill_parts.h: what a scene becomes: bone, the steps, and the mailboxes between them. A schedule calls them: lockstep
/// (simulation.cpp), on threads (live_run.h), or in the order of a record (live_replay.h).
#pragma once

#include <memory>
#include <optional>

#include "app/engine/approach.h"
#include "app/engine/bone_step.h"
#include "app/engine/contact_tick.h"
#include "app/engine/frame_step.h"
#include "app/engine/scene.h"
#include "haptics/servo/servo_step.h"

namespace burrhole {

/// The mean cutting force since it was last asked for: one sample of a force that rings would alias into what is cut.
class MeanThrust {
 public:
  /// [N]; where contact has not looked again since, what it was before.
  [[nodiscard]] double operator()(const ContactState& now) noexcept {
    if (now.number > number_) mean_ = (now.cutting_sum - sum_) / static_cast<double>(now.number - number_);
    number_ = now.number;
    sum_ = now.cutting_sum;
    return mean_;
  }

 private:
  double mean_ = 0.0, sum_ = 0.0;
  std::uint64_t number_ = 0;
};

/// Of [device]: by what the drill's force is multiplied at the grip; 1 without a device.
[[nodiscard]] double force_scale_of(const Scene& scene) noexcept;

struct DrillParts {
  struct Outside {
    FrameSink* sink = nullptr;
    HandSource* hand = nullptr;  ///< nothing: the scene's own
    std::string restore_path;
  };
  /// `tool` and what `outside` points to must outlive the parts. Errors carry the scene's places where there is one.
  [[nodiscard]] static Result<std::unique_ptr<DrillParts>> make(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                                                const Outside& outside);
  DrillParts(const DrillParts&) = delete;
  DrillParts& operator=(const DrillParts&) = delete;

  /// One step of bone towards what contact found last; simulation thread.
  void cut(const ContactState& found) { (*bone)(found.world_from_tool, thrust(found), bone_period); }

  Scene scene;
  const Tool* tool;
  double period, contact_period, bone_period;       // [s]
  std::uint64_t contact_every = 1, bone_every = 4;  // servo ticks
  std::uint64_t latency = 1;                        // servo ticks from a motion to its force, in lockstep
  Approach approach;
  std::unique_ptr<Voxmap> voxmap;
  std::optional<SimulatedHand> own_hand;
  std::unique_ptr<SimulatedDevice> device;  // of a scene with [device]
  std::optional<ScriptedDeviceHand> device_hand;
  HandSource* hand = nullptr;                ///< the scene's own, or the one given
  TripleBuffer<HandState> hand_mailbox;      // servo -> contact
  TripleBuffer<ContactState> force_mailbox;  // contact -> servo
  TripleBuffer<ContactState> tool_mailbox;   // contact -> simulation
  std::optional<ServoStep> servo;
  std::optional<ContactTick> contact;
  std::optional<BoneStep> bone;
  MeanThrust thrust;
  std::optional<FrameStep> frame;

 private:
  DrillParts(const Scene& scene, const Tool& tool);
  [[nodiscard]] Status build_hand(const Pose& world_from_approach, HandSource* given);
  [[nodiscard]] Status build(std::shared_ptr<const BoneModel> model, const Outside& outside);
};

}  // namespace burrhole
