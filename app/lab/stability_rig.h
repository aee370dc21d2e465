/// app/lab/stability_rig.h: one hard case put together, and what is looked at in each of its ticks.
///   Frame  world, but for the trace's grip columns.   Units SI.   Thread one.
#pragma once

#include <memory>

#include "app/engine/load.h"
#include "app/engine/lockstep.h"
#include "app/lab/stability_hand.h"
#include "volumes/phantom/truth.h"

namespace burrhole {

class StabilityRig {
 public:
  /// `of` must outlive it. The scene's own faults pass through.
  [[nodiscard]] static Result<std::unique_ptr<StabilityRig>> create(const StabilityCase& of, const StabilityModel& model, bool sabotaged);

  /// One tick of the servo; a sample for each tick of the device in it.
  void tick(std::vector<StabilitySample>& samples);
  [[nodiscard]] double period() const noexcept { return parts_->period; }
  [[nodiscard]] TraceContext context() const;
  [[nodiscard]] std::size_t points() const noexcept { return loaded_->tool.shell.size(); }

 private:
  explicit StabilityRig(const StabilityCase& of, bool sabotaged) : case_(&of), sabotaged_(sabotaged) {}
  [[nodiscard]] Status put_together(const StabilityModel& model);
  /// Before a tick: what goes wrong in it, and where bone is now.
  void prepare(double time);
  void move_bone(double time);
  void look_at_tool(StabilitySample& sample);
  /// [N] of the force, which bone cannot have pushed with. Where it does not point into the bone nearest to the tool's deepest point, none.
  /// Where it does, and that is all the bone there is: its part towards bone, or of bone as loaded its whole length, which is more. Where
  /// other walls are touched, by the tool as it was since the loop's latency, its distance from what all of them can push with
  /// (push_cone.h). Of bone that is cut the walls are no excuse: what counts is the axis.
  [[nodiscard]] double pull_of(const StabilitySample& sample) const;
  void remember(const Pose& bone_from_tool);
  [[nodiscard]] bool bone_between(const Pose& world_from_tool, const Vec3& hand) const;
  /// Of the tool's points the deepest, or the nearest to bone as loaded.
  [[nodiscard]] SurfaceDistance nearest_of(const Pose& bone_from_tool) const;
  [[nodiscard]] double depth_under(const Pose& bone_from_tool, const SurfaceDistance& least) const;
  [[nodiscard]] double density_at(const Vec3& in_bone) const;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& in_bone) const;

  const StabilityCase* case_;
  bool sabotaged_;
  std::unique_ptr<LoadedScene> loaded_;
  std::unique_ptr<Truth> truth_;
  std::unique_ptr<StabilityHand> hand_;
  std::unique_ptr<DrillParts> parts_;
  std::optional<Lockstep> loop_;
  Pose world_from_bone_;
  Vec3 carried_{0.0}, shift_{0.0};  // device frame; world, of loose bone
  Vec3 last_force_{0.0};
  bool touched_ = false;
  struct Was {
    std::uint64_t since;  // tick
    Pose bone_from_tool;
  };
  std::vector<Was> lately_;  // where the tool was while forces that are felt now were on their way, the oldest first
};

}  // namespace burrhole
