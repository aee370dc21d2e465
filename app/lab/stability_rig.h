/// app/lab/stability_rig.h: runs one hard case tick by tick and samples it.
///   Frame  world, except the grip columns of the trace.   Units SI.   Errors  those of the scene.   Thread one.
#pragma once

#include <memory>

#include "app/lab/oracle/solid_depth.h"
#include "app/lab/stability_hand.h"
#include "app/run/lockstep.h"
#include "app/scene/load.h"
#include "volumes/phantom/truth.h"

namespace burrhole {

class StabilityRig {
 public:
  /// @pre `of` outlives the rig. Errors of the scene are returned.
  [[nodiscard]] static Result<std::unique_ptr<StabilityRig>> create(const StabilityCase& of, const StabilityModel& model, bool sabotaged);

  /// Runs one tick of the servo and appends a sample for each tick of the device in it.
  void tick(std::vector<StabilitySample>& samples);
  [[nodiscard]] double period() const noexcept { return parts_->period; }
  [[nodiscard]] TraceContext context() const;
  [[nodiscard]] std::size_t points() const noexcept { return loaded_->tool.shell.size(); }

 private:
  explicit StabilityRig(const StabilityCase& of, bool sabotaged) : case_(&of), sabotaged_(sabotaged) {}
  [[nodiscard]] Status put_together(const StabilityModel& model);
  /// Call before a tick: applies disturbances and the motion of the bone.
  void prepare(double time);
  void move_bone(double time);
  void sample_tool(StabilitySample& sample);
  /// @returns the part [N] of the force that bone cannot exert. It is 0 if the force does not point into the bone nearest to the tool's
  /// deepest point. Otherwise: without other walls, the component of the force towards bone, or its whole length for bone as loaded, which
  /// is larger; with other walls touched by the tool within the loop's latency, the distance of the force from the cone of their normals
  /// (contact_cone.h). For bone that is being cut, walls are ignored and only the axis counts.
  [[nodiscard]] double attractive_force_of(const StabilitySample& sample) const;
  void remember(const Pose& bone_from_tool);
  [[nodiscard]] bool bone_between(const Pose& world_from_tool, const Vec3& hand) const;
  /// Distance at the deepest point of the tool, or at the point nearest to bone as loaded.
  [[nodiscard]] SurfaceDistance nearest_of(const Pose& bone_from_tool) const;
  /// [m] Of the tool's points below the 0.5 surface, or of bone inside the solid of the tool where that is more and asked for.
  [[nodiscard]] double depth_under(const Pose& bone_from_tool, const SurfaceDistance& least) const;
  [[nodiscard]] double density_at(const Vec3& in_bone) const;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& in_bone) const;

  const StabilityCase* case_;
  bool sabotaged_;
  std::unique_ptr<LoadedScene> loaded_;
  std::unique_ptr<Truth> truth_;
  std::optional<SolidDepth> solid_;  // where penetration is bounded
  std::unique_ptr<StabilityHand> hand_;
  std::unique_ptr<Stage> parts_;
  std::optional<Lockstep> loop_;
  Pose world_from_bone_;
  Vec3 carried_{0.0}, shift_{0.0};  // [m] device frame; [m] world, of free bone
  Vec3 last_force_{0.0};
  bool touched_ = false;
  struct Was {
    std::uint64_t since;  // tick
    Pose bone_from_tool;
  };
  std::vector<Was> lately_;  // poses of the tool within the latency of the forces, the oldest first
};

}  // namespace burrhole
