/// app/stage/stage.h: bone, tool, hand, servo, master window, clocks and mailboxes, and the steps bound by the scene's effects.
///   A schedule (app/run) runs the steps: in lockstep, on threads, or in the order of a recorded session.
///   Frame  world unless stated.   Units  SI.   Errors  bad_input, out_of_range: see the functions.
///   Threads  created and rebound while no clock runs; each function states the thread that calls it during a run.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/stage/bone_step.h"
#include "app/stage/contact_tick.h"
#include "app/stage/effect.h"
#include "app/stage/slots.h"
#include "app/view/frame_step.h"
#include "core/measure/approach.h"
#include "core/sound/sound_sink.h"
#include "core/voxel/bone_history.h"

namespace burrhole {

/// Mean cutting force since the last call. The mean avoids aliasing of an oscillating force.
class MeanThrust {
 public:
  /// @returns the mean [N]; the previous mean if contact has no new evaluation.
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

/// @returns a result as seen from the bone at rest (BoneMotion).
[[nodiscard]] ContactState seen_at_rest(const ContactState& found) noexcept;

/// @returns the servo's configuration with the limits required by the effects, at the rates of the scene. @param voxel_edge [m].
[[nodiscard]] ServoConfig servo_config(const StageConfig& config, const Needs& needs, double voxel_edge);
/// @returns the script's configuration of [hand]. If a constrained tool drills, the values of breakthrough detection follow from the scene:
/// exit_drop and cut_compliance from the stiffness of coupling and cutting, rough_drop from the voxel edge, `softest` from the bit.
/// @param voxel_edge [m].
[[nodiscard]] HandConfig hand_config(const StageConfig& config, const Needs& needs, const Tool& tool, double voxel_edge);
/// @returns the hand of [hand]. @param goals needed by hand.kind = "mouse"; a script's hand can be taken over with them. Errors as SimulatedHand, FeedHand and GoalHand; unavailable
/// where a user's hand has no goals.
[[nodiscard]] Result<std::unique_ptr<HandSource>> make_hand(const StageConfig& config, const Needs& needs, const Tool& tool,
                                                            double voxel_edge, const Pose& world_from_approach,
                                                            GoalMailbox* goals = nullptr);

class Stage {
 public:
  /// External objects of a run; they must outlive the stage.
  struct Outside {
    FrameSink* sink = nullptr;
    HandSource* hand = nullptr;    ///< null: the scene's own hand
    GoalMailbox* goals = nullptr;  ///< of a user; null: nobody is there
    std::string restore_path{};    ///< checkpoint to start from; empty: bone as loaded
    bool history = false;          ///< enables undo and checkpoints
    SoundSink* sound = nullptr;    ///< receives the samples of [sound]; null: none are made
    bool one_thread = false;       ///< all steps run on one thread: contact reads one copy of bone instead of three
    bool runs = true;              ///< false: no step is called, as for a check or a picture; contact gets no copy of bone
  };
  /// `tool` and the objects in `outside` must outlive the stage. Errors include the scene's place if there is one.
  [[nodiscard]] static Result<std::unique_ptr<Stage>> make(const StageConfig& config, const EffectPlans& plans,
                                                           std::shared_ptr<const BoneModel> bone, const Tool& tool, const Outside& outside);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();

  /// Simulation thread: runs one simulation step, in which the tool moves from the pose of the previous step to that of `found`.
  void cut(const ContactState& found);
  /// Servo thread, after the hand was read: runs the effects' steps, then computes and limits the force, and applies it to the hand.
  const ServoOutput& act() noexcept BH_REALTIME;
  /// Simulation thread, between two steps: collects changed boxes for the display. @param all true: ignores the scene's budget.
  void gather(bool all = false);
  /// Frame thread: draws one picture. @param world_from_tool absent: the tool is not drawn. @param opened clips bone at a plane through the
  /// approach axis.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool opened);
  /// Frame thread: draws the next frame of the run's film, which is not one of its pictures.
  [[nodiscard]] Status film(const Pose& world_from_tool);

  // Inputs of a user between two ticks, while no clock runs. Changes are published at once, and the force is ramped up again. A tool that would
  // be inside bone is placed outside it (free_place.h); a penalty model without coupling has the pose of its hand.
  /// Replaces the tool, which must outlive the stage. out_of_range: too large for the bone's voxels. After an error the run must end.
  [[nodiscard]] Status change_tool(const Tool& other);
  /// Restores the bone before the last start of the spindle. @returns false if there is nothing to undo, or no history. Errors as place().
  [[nodiscard]] Result<bool> undo();
  /// Restores the bone as loaded.
  [[nodiscard]] Status reset();
  /// Stores or restores a checkpoint. Errors as BoneHistory; bad_input without a history.
  [[nodiscard]] Status checkpoint(const std::string& name);
  [[nodiscard]] Status restore(const std::string& name);
  [[nodiscard]] const BoneHistory* history() const noexcept { return history_.get(); }

  /// For effects, in make(): sets the hand source in place of the scene's script. Ignored if Outside::hand is set.
  void offer_hand(HandSource& offered) noexcept { offered_hand_ = &offered; }
  /// For effects, in make(): sets the frame step that draws.
  void offer_frame(FrameStep& offered) noexcept { frame_ = &offered; }
  /// For effects, in make(): sets where the bone is at the start. @param world_from_rest as in BoneMotion.
  void offer_bone_pose(const Pose& world_from_rest) noexcept { world_from_rest_ = world_from_rest; }
  /// For effects, in make(): requests a session file. @param path relative to the output folder. @param timer receives the time in which
  /// the rows of each servo tick are recorded.
  void offer_record(std::string path, StepTimer& timer) {
    record_path_ = std::move(path);
    record_timer_ = &timer;
  }
  [[nodiscard]] const std::optional<std::string>& record_path() const noexcept { return record_path_; }
  [[nodiscard]] StepTimer* record_timer() noexcept { return record_timer_; }  ///< null without a session file
  [[nodiscard]] const Outside& outside() const noexcept { return outside_; }
  [[nodiscard]] FrameStep* frame() noexcept { return frame_; }
  /// @returns the number of simulation steps completed before the last gather(). The next picture shows bone after these steps.
  [[nodiscard]] std::uint64_t frame_step() const noexcept { return gathered_; }
  [[nodiscard]] Pose world_from_approach() const noexcept { return config.volume.world_from_bone * approach.bone_from_approach; }
  /// @returns the number of blocks of sound that are due after a number of servo ticks.
  [[nodiscard]] std::uint64_t audio_blocks(std::uint64_t servo_ticks) const noexcept {
    return static_cast<std::uint64_t>(static_cast<double>(servo_ticks) * period / kAudioPeriod + 1e-6);
  }
  [[nodiscard]] double voxel_edge() const noexcept { return voxmap->bone().bone_from_index().mean_edge(); }  ///< [m]

  struct MadeEffect {
    std::string table;
    std::unique_ptr<Effect> effect;
  };
  [[nodiscard]] const std::vector<MadeEffect>& effects() const noexcept { return effects_; }
  /// Sets the tool's pose without contact, and places the window round it. out_of_range as BoneStep::place().
  [[nodiscard]] Status place(const Pose& world_from_tool);
  /// Adds the warnings of a run that has ended: those of the effects, and a limit cycle of the force.
  void warn(std::vector<std::string>& out) const;
  /// @returns a number that an effect reports (Effect::report), by table and name; absent if there is none.
  [[nodiscard]] std::optional<double> figure(std::string_view table, std::string_view name) const;

  StageConfig config;
  const Tool* tool;
  Needs needs;
  double period, contact_period, bone_period;       ///< [s]
  std::uint64_t contact_every = 1, bone_every = 4;  ///< [servo ticks]
  std::uint64_t latency = 1;                        ///< [servo ticks] from a motion to its force, in lockstep
  Approach approach;
  std::unique_ptr<Voxmap> voxmap;
  HandSource* hand = nullptr;
  TripleBuffer<HandState> hand_mailbox;      ///< servo -> contact
  TripleBuffer<ContactState> force_mailbox;  ///< contact -> servo
  TripleBuffer<ContactState> tool_mailbox;   ///< contact -> simulation
  std::optional<ServoStep> servo;
  std::optional<ContactTick> contact;
  std::optional<BoneStep> bone;
  StepGraph graph;

 private:
  Stage(const StageConfig& config, const Needs& needs, const Tool& tool, const Outside& outside);
  [[nodiscard]] Status build(const EffectPlans& plans, std::shared_ptr<const BoneModel> model);
  [[nodiscard]] Status build_hand();
  [[nodiscard]] Status bind();
  [[nodiscard]] Status draw_picture(const Picture& picture);
  void watch_spin(double command);
  void place_effects(const Pose& world_from_tool);
  [[nodiscard]] Status bone_was_changed();
  [[nodiscard]] Status free_tool();  ///< takes the tool out of bone that it does not cut
  void notify_hand();                ///< HandSource::scene_changed() with the present tool

  Outside outside_;
  std::vector<MadeEffect> effects_;
  HandSource* offered_hand_ = nullptr;
  FrameStep* frame_ = nullptr;
  std::optional<std::string> record_path_;
  StepTimer* record_timer_ = nullptr;
  std::unique_ptr<HandSource> own_hand_;
  std::unique_ptr<CoarseDistance> coarse_;  // of the bone as loaded; null: bone exerts no force
  std::unique_ptr<BoneHistory> history_;    // of voxmap
  bool spun_ = false;                       // in the last step of bone
  MeanThrust thrust_;
  HandState* hand_slot_ = nullptr;
  const Vec3* added_force_ = nullptr;
  Pose world_from_rest_;             // at the start
  BoneMotion* bone_slot_ = nullptr;  // null: nothing reads it
  Picture* picture_slot_ = nullptr;
  Status** picture_error_ = nullptr;
  std::uint64_t servo_tick_ = 0, pictures_ = 0, gathered_ = 0;
};

}  // namespace burrhole
