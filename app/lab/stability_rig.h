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
  void look_at_tool(StabilitySample& sample) const;
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
};

}  // namespace burrhole
