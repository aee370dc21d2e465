/// core/contact/constrained_tool.h: contact model `surface`: the tool as a body of its own, tied to the hand by springs and dampers in all
///   six degrees of freedom and held back, without friction, by the 0.5 surface of bone.
///   Frame  world; poses are of the tool frame.   Units SI.   Thread contact.
///   What bone resists: a tool at rest cannot enter the surface; a spinning one engages by F / K_cut where it cuts, along the push; across
///   it cutting points have a play of up to three quarters of a voxel, and the engaged flanks hold (side_grip.h). The *held* pose is the
///   tool moved back by its engagement: cutting points are felt there, so bone is met from its own side however deep the tool is engaged;
///   points that cannot cut are felt where the tool is. Massless: coupling and contact forces balance. Bone that is cut holds what lies in
///   it and throws nothing out (push_out).
///   Outside what the window knows the tool waits, and its force stays that of the last look.
///   Swept: no move is longer than what its look-ahead has seen, so a fast stroke passes nothing unseen.
///   Source  own derivation (hold_solver.h); proxies held back by a surface are the field's custom.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/drawn_shell.h"
#include "core/contact/facing_points.h"
#include "core/contact/hit_places.h"
#include "core/contact/hold_solver.h"
#include "core/contact/local_contact.h"
#include "core/contact/near_spots.h"
#include "core/contact/side_grip.h"
#include "core/contact/surface_probe.h"

namespace burrhole {

struct ConstrainedToolConfig {
  double coupling_stiffness = 5000.0;  ///< [N/m] hand to tool
  double coupling_damping = 10.0;      ///< [N s/m]
  double turn_stiffness = 20.0;  ///< [N m/rad] hand to tool; infinite: rotation is the hand's. Damped with the time constant of the above
  double cutting_stiffness = 100e3;  ///< [N/m] K_cut: thrust over engaged depth of a spinning tool
  double bone_stiffness = 20e6;      ///< [N/m] of bone of relative stiffness 1 under one plane; scaled by max(relative stiffness, 0.1)
  double side_grip = 1.0;            ///< [-] part of what engaged flanks resist sideways; 0: none
  /// [N] with which bone that is cut, in a period, pushes points out that lie in it; without bound: as far as the surface. What is cut has
  /// no work to give: it holds. A ball whose widest part has passed a rim lies in the rim's far side, by its play and since planes are not
  /// quite the surface; moved out of it at once it is thrown 0.4 mm ahead of its springs and pulls the hand by 4 N. Half of what a device's
  /// friction hides.
  double push_out = 0.025;
  int max_moves = 40;  ///< moves in one step: bounds cost and speed, never safety
};

/// What one step needs to know of the hand.
struct HandMotion {
  Pose world_from_hand;  ///< where the hand would have the tool
  Vec3 velocity{0.0};    ///< [m/s]
  bool spinning = false;
};

/// Bone as the constrained tool reads it; what it points to must outlive the view.
struct SurfaceView {
  RecordView records;
  const std::uint8_t* stiffness = nullptr;  ///< relative, 255 is 1 (contact_window.h); dense over records.box; null: 1 everywhere
  Pose world_from_bone;
};

struct ConstrainedToolState {
  Pose world_from_tool;
  Vec3 aside{0.0};             ///< [m] world: of what is engaged, from where it is cut, across the push
  Wrench on_hand;              ///< what the tool exerts on the hand: force [N], torque [N m] about the tool origin
  double engagement = 0.0;     ///< [m] engaged depth of the cutting points, F / K_cut
  double cutting_force = 0.0;  ///< [N] of the planes that are cut, as one vector
  std::uint32_t moves = 0;
  std::uint32_t flags = 0;  ///< ContactFlag
};

class ConstrainedTool {
 public:
  /// out_of_range when a stiffness is not above 0, damping is negative, or the shell is empty or too large.
  [[nodiscard]] static Result<ConstrainedTool> create(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge);

  /// Places the tool without looking at bone (start of a run, after a teleport of the scene).
  void place(const Pose& world_from_tool) noexcept;
  /// One contact period. Never allocates. A bone that was moved takes the tool along before the hand's pull is answered, so that it cannot
  /// be moved through the tool either.
  const ConstrainedToolState& step(const SurfaceView& bone, const HandMotion& hand, double dt) noexcept BH_REALTIME;
  [[nodiscard]] const ConstrainedToolState& state() const noexcept { return state_; }
  [[nodiscard]] const PointShell& shell() const noexcept { return shell_; }
  /// After a step on that bone: its contact as planes, loaded ones first, then the nearest of each spot of the tool. Kind `none` where the
  /// window did not know enough.
  /// @param reach [m] how far the tool may come before it is asked again: what is nearer is listed, as far as records know.
  void describe(const SurfaceView& bone, double reach, LocalContact& out) noexcept BH_REALTIME;
  /// Planes that carry load at the state; normals and arms in the axes of the bone frame.
  [[nodiscard]] std::span<const HoldPlane> planes() const noexcept { return solver_.planes(); }

 private:
  class Candidates;
  ConstrainedTool(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge);
  /// Where springs and dampers alone would bring the tool, and how stiff they are together.
  struct Pull {
    Pose world_from_target;
    double stiffness, turn_stiffness;
  };
  [[nodiscard]] Pull pull_of(const HandMotion& hand, double dt) const noexcept;
  /// A shell point, drawn in across the push by the play where it cuts [m], tool frame.
  [[nodiscard]] Vec3 drawn_in(std::size_t point) const noexcept;
  void set_play(bool spinning) noexcept;
  /// Feels what is engaged at the true pose.
  void grip(const SurfaceView& bone, bool spinning) noexcept;
  void look(const SurfaceView& bone, bool spinning, double look_ahead) noexcept;
  /// Cutting points that lie deeper than bone gives way under their load and `furthest_out` [m] besides are taken to lie so deep: bone
  /// holds them there and pushes them out by no more.
  void let_lie(double furthest_out) noexcept;
  [[nodiscard]] HoldMove solve(const SurfaceView& bone, const Pose& bone_from_target, const Pull& pull, bool spinning) noexcept;
  /// Of a plane that does not cut: where it is felt, and the record's normal there.
  [[nodiscard]] Vec3 direction(const SurfaceView& bone, const HoldPlane& plane, const Vec3& position, const Vec3& normal,
                               bool spinning) const noexcept;
  void sweep(const SurfaceView& bone, const Pull& pull, bool spinning) noexcept;
  void apply(const HoldMove& move, double part) noexcept;
  /// A force on the hand does not turn round within a period: where bone's give under a ring of loads throws a cutting tool a little past
  /// where its springs balance, it rests there for that period. @param before [N] bone frame: the force of the period before.
  void pass_through_nothing(const Pose& bone_from_target, const Vec3& before) noexcept;
  void report(const SurfaceView& bone) noexcept;

  ConstrainedToolConfig config_;
  PointShell shell_;
  Vec3 middle_{0.0};  // [m] tool frame: points_ are about it
  ContactShell points_;
  ContactShellPart gripping_;  // cutting points that tell how bone holds sideways: all of them, or so many evenly chosen
  FacingPoints facing_;        // picks from those
  DrawnShell drawn_;           // draws the cutting points of points_
  double edge_ = 0.0;          // [m]
  NearSpots spots_;
  HitPlaces places_;
  ProbeHits hits_;
  std::size_t cutting_hits_ = 0;  // the first so many hits are of cutting points
  HoldSolver solver_;
  SideGrip grip_;
  Pose bone_from_tool_;
  Vec3 engaged_{0.0};         // [m] bone frame: the held pose is the tool's moved by this
  HoldMove since_look_;       // how the tool moved since gaps were measured; engagement: by how much it grew
  double play_ = 0.0;         // [m]
  Vec3 push_{0.0, 0.0, 1.0};  // unit, tool frame: against the thrust
  Pose world_from_bone_;
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  bool spinning_ = false;  // in the step before
  bool placed_ = false;    // the frames above are from the step before
  ConstrainedToolState state_;
};

}  // namespace burrhole
