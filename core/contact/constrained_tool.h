/// core/contact/constrained_tool.h: contact model `surface`: a massless tool with its own pose. Springs and dampers in six degrees of
///   freedom couple it to the hand; the 0.5 surface of bone constrains it.
///   Frame  world; poses are of the tool frame.   Units SI.   Thread contact.
///   Contact  A tool at rest cannot enter the surface. A spinning tool engages by the depth F / K_cut along the push. Across the push,
///            cutting points have a clearance of up to three quarters of a voxel, and engaged flanks have a lateral stiffness
///            (flank_friction.h).
///   Proxy pose  The pose of the tool moved back by its engagement. Cutting points are tested at the proxy pose, so that contact always
///   comes from the outer side of bone, at any engaged depth. Other points are tested at the tool's pose.
///   Equilibrium  Coupling forces and contact forces balance. The depenetration limit (push_out) bounds the force on points inside bone
///                that is cut.
///   Places  At spin 0 contact is at places of the tool's surface: a plane follows the place of its contact (contact_place.h), and bone that
///           reaches the tool between its shell points is searched for (shell_cells.h). A spinning tool touches at its shell points only.
///   Stopped  A tool whose spin ends in its hole reaches into bone: by its engagement, and where distances between voxels round the edges of
///            the hole. It has cut there, so bone does not push it out: contact begins at the deepest of this overlap, which shrinks as the
///            tool leaves and never grows.
///   Window  Outside the window the tool moves freely as far as the coarse distance proves that no bone is near. Beyond, it is held: the
///           force is that of its springs, as at a wall (hold_force.h).
///   Tangential loads, such as friction, come from a TangentialLaw (tangential_hold.h); without one the surface is frictionless.
///   Continuous collision  No move is longer than the distance in which planes are known, so a fast stroke cannot pass through bone.
///   Source  own derivation (hold_solver.h); constraining a proxy at a surface is usual in the field.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/result.h"
#include "core/contact/cleared_shell.h"
#include "core/contact/contact_additions.h"
#include "core/contact/contact_flag.h"
#include "core/contact/facing_points.h"
#include "core/contact/felt_hardness.h"
#include "core/contact/flank_friction.h"
#include "core/contact/hand_motion.h"
#include "core/contact/hit_places.h"
#include "core/contact/hold_force.h"
#include "core/contact/hold_solver.h"
#include "core/contact/lens_shell.h"
#include "core/contact/local_contact.h"
#include "core/contact/searched_places.h"
#include "core/contact/shell_cells.h"
#include "core/contact/shell_cover.h"
#include "core/contact/shell_regions.h"
#include "core/contact/surface_view.h"
#include "core/contact/tangential_hold.h"

namespace burrhole {

struct ConstrainedToolConfig {
  double coupling_stiffness = 5000.0;  ///< [N/m] hand to tool
  double coupling_damping = 10.0;      ///< [N s/m]
  double turn_stiffness = 20.0;  ///< [N m/rad] hand to tool; infinite: the hand's rotation. Damped with the time constant of the coupling
  double cutting_stiffness = 140e3;  ///< [N/m] K_cut: thrust over engaged depth of a spinning tool
  double bone_stiffness = 20e6;      ///< [N/m] of bone of relative stiffness 1 under one plane; scaled by max(relative stiffness, 0.1)
  double felt_hardness = 0.0;   ///< [-] 0..1 share by which the coupling is softer on bone of hardness 0 (felt_hardness.h); 0: constant
  double flank_friction = 1.0;  ///< [-] factor on the lateral stiffness of engaged flanks while cutting; 0: none
  /// [N] depenetration limit: the largest force per period with which bone that is cut moves penetrating points towards the surface;
  /// infinite: the full correction. Cutting stores no energy, so bone must not accelerate the tool outwards. Example: a ball whose widest
  /// part has passed a rim penetrates the far side of the rim, because of its clearance and because planes only approximate the surface. A
  /// full correction in one period moves it 0.4 mm beyond its springs' equilibrium and exerts 4 N on the hand. The default is half of the
  /// force that the friction of a device masks.
  double push_out = 0.025;
  int max_moves = 40;  ///< largest number of moves in a step: bounds cost and speed, and does not affect safety
};

struct ConstrainedToolState {
  Pose world_from_tool;
  Vec3 aside{0.0};             ///< [m] world: lateral displacement of the engaged part from the place where it cut, across the push
  Wrench on_hand;              ///< wrench of the tool on the hand: force [N], torque [N m] about the tool origin
  Wrench tangential;           ///< [N], [N m] part of on_hand from a tangential law
  double engagement = 0.0;     ///< [m] engaged depth of the cutting points, F / K_cut
  double cutting_force = 0.0;  ///< [N] magnitude of the resultant of the cutting planes
  std::uint32_t moves = 0;
  std::uint32_t flags = 0;  ///< ContactFlag
};

/// What is known of a tool beside the points of its shell.
struct ConstrainedToolParts {
  /// The cutting part as a solid, for bone that is cut at sub-voxel resolution; null: bone is cut by whole voxels.
  std::shared_ptr<const CuttingField> cutting{};
  /// The surface between the points; null: the tool is its points.
  std::shared_ptr<const ToolSurface> surface{};
};

class ConstrainedTool {
 public:
  /// Errors: out_of_range when a stiffness is not above 0, damping is negative, or the shell is empty or too large.
  [[nodiscard]] static Result<ConstrainedTool> create(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge,
                                                      ConstrainedToolParts parts = {});

  /// Places the tool without a query of bone (start of a run, after a jump of the scene).
  void place(const Pose& world_from_tool) noexcept;
  /// One contact period. Never allocates. A moved bone first moves the tool along, before the coupling acts, so that bone cannot move
  /// through the tool. Cutting points cut while spin.spinning.
  const ConstrainedToolState& step(const SurfaceView& bone, const HandMotion& hand, double dt, const ToolSpin& spin = {},
                                   const ContactAdditions& added = {}) noexcept BH_REALTIME;
  [[nodiscard]] const ConstrainedToolState& state() const noexcept { return state_; }
  [[nodiscard]] const PointShell& shell() const noexcept { return shell_; }
  [[nodiscard]] const ConstrainedToolConfig& config() const noexcept { return config_; }
  [[nodiscard]] double coupling_stiffness() const noexcept { return coupling_; }  ///< [N/m] of the next step
  /// After a step on that bone: writes its contact as planes, loaded ones first, then the nearest plane of each spot of the tool. Kind
  /// `none` where the window did not know enough.
  /// @param reach [m] distance that the tool may cover until the next call; nearer planes are listed, as far as records are known.
  void describe(const SurfaceView& bone, double reach, LocalContact& out) noexcept BH_REALTIME;
  /// Planes that carry load; normals and arms in the axes of the bone frame.
  [[nodiscard]] std::span<const HoldPlane> planes() const noexcept { return solver_.planes(); }

 private:
  class Candidates;
  static constexpr double kFarLookAfter = 0.05;  // [voxel edges]
  static constexpr float kHidden = 1e9f;         // [voxel edges] beyond any hit
  ConstrainedTool(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge, ConstrainedToolParts parts);
  /// The equilibrium of springs and dampers without contact, and their total stiffness.
  struct Pull {
    Pose world_from_target;
    double stiffness, turn_stiffness;
  };
  /// [-] Relative stiffness of bone under the contacts; -1: the bone has none, or no contact that pushes has bone under it.
  [[nodiscard]] double hardness_under_contacts(const SurfaceView& bone) const noexcept;
  /// At the end of a step: the coupling of the next one. @param from [m] bone frame: proxy position at the start of the step.
  void feel_hardness(const SurfaceView& bone, const Vec3& from, double dt) noexcept;
  [[nodiscard]] Pull pull_of(const HandMotion& hand, double dt) const noexcept;
  /// [m] A shell point in the tool frame; a cutting point is moved inwards, across the push, by the clearance.
  [[nodiscard]] Vec3 cleared(std::size_t point) const noexcept;
  [[nodiscard]] double own_give() const noexcept;  // [-] kOwnGive of the kind of removal
  /// Compliance of a plane [m/N]. @param position of its contact, bone frame.
  [[nodiscard]] double yield_of(const SurfaceView& bone, const HoldPlane& plane, const Vec3& position) const noexcept;
  void set_clearance(bool spinning) noexcept;
  /// Measures the lateral stiffness of what is engaged, at the tool's pose.
  void measure_flanks(const SurfaceView& bone, bool spinning) noexcept;
  void look(const SurfaceView& bone, bool spinning, double look_ahead) noexcept;
  /// Whether contact is at places of the tool's surface, and not at its shell points only. A spinning tool tests its cutting points at the
  /// proxy pose, where they are not on its surface.
  [[nodiscard]] bool follows_surface(bool spinning) const noexcept { return surface_ != nullptr && !spinning; }
  /// The part of look() for places between the points: bounds of all hits, and the places that are known.
  void look_between(const SurfaceView& bone, bool far) noexcept;
  /// Whether the tool has moved so far since bone was probed as far as the cells of its points reach that deep bone may be new.
  [[nodiscard]] bool far_look_due() const noexcept { return since_far_look_ > kFarLookAfter * edge_; }
  void forget_places() noexcept {
    searched_.clear();
    since_far_look_ = 1.0;
  }
  /// Moves a plane's place to the contact next to it, and sets all but the point. @returns false where bone is not near.
  [[nodiscard]] bool settle(const SurfaceView& bone, const PlaceFinder& finder, HoldPlane& plane) const noexcept;
  /// The same for a kept plane, and for the place that was searched for it.
  [[nodiscard]] bool settle_kept(const SurfaceView& bone, const PlaceFinder& finder, HoldPlane& plane) noexcept;
  /// @returns the shell point of the hit that is nearest to a place of the tool; `point` where there are no hits.
  [[nodiscard]] std::uint32_t nearest_hit(const Vec3& place, std::uint32_t point) const noexcept;
  /// Moves a place with the contact next to it. @returns false where it is no longer of use.
  [[nodiscard]] bool follow(const PlaceFinder& finder, SearchedPlaces::Place& place, bool far) const noexcept;
  /// Limits depenetration: for a cutting point deeper than the compliance of bone under its load plus `furthest_out` [m], sets the gap so
  /// that bone holds the point there and moves it outwards by no more than `furthest_out`.
  void let_lie(double furthest_out) noexcept;
  [[nodiscard]] HoldMove solve(const SurfaceView& bone, const Pose& bone_from_target, const Pull& pull, bool spinning) noexcept;
  [[nodiscard]] HoldMove solve_with(const SurfaceView& bone, const HoldProblem& problem, HoldCandidates& candidates) noexcept;
  /// Start and end of a step, for its additions.
  void begin_added(const ContactAdditions& added, double spin_rate, double dt, bool placed) noexcept;
  void end_added() noexcept;
  /// The normal of a plane that does not cut. @param position of its contact. @param normal of the record there.
  [[nodiscard]] Vec3 direction(const SurfaceView& bone, const HoldPlane& plane, const Vec3& position, const Vec3& normal,
                               bool spinning) const noexcept;
  /// The normal of a plane that cuts. A smooth face of the tool that touches bone is tangent to it, so its normal is the tool's, also where
  /// bone has an edge; at an edge of the tool it is that of bone. @param bone_normal of the record there.
  [[nodiscard]] Vec3 cutting_normal(std::size_t point, const Vec3& bone_normal) const noexcept;
  /// At the start of a step: updates lying_. @param was_spinning in the last step.
  void let_overlap_lie(const SurfaceView& bone, bool was_spinning) noexcept;
  [[nodiscard]] SurfaceView lying_in(const SurfaceView& bone) const noexcept;
  void sweep(const SurfaceView& bone, const Pull& pull, bool spinning) noexcept;
  /// Outside the window. @returns the distance [m] that no point of the tool can move without being far from bone; 0: bone may be near.
  [[nodiscard]] double free_distance(const SurfaceView& bone) const noexcept;
  /// Moves the tool to the target without contact, by `free` [m] at most. @returns whether it has arrived.
  bool move_freely(const Pose& bone_from_target, double free) noexcept;
  /// The result where bone has not been read: the springs hold the hand as if the tool stood at a wall.
  void hold(const Pull& pull) noexcept;
  void apply(const HoldMove& move, double part) noexcept;
  void report(const SurfaceView& bone) noexcept;

  ConstrainedToolConfig config_;
  PointShell shell_;
  Vec3 middle_{0.0};  // [m] tool frame: origin of points_
  ContactShell points_;
  ContactShellPart flank_points_;  // cutting points that sample the lateral stiffness: all, or an even subset
  FacingPoints facing_;            // selects from those
  ClearedShell cleared_;           // applies the clearance to the cutting points of points_
  LensShell lens_;                 // the same where the cutting part is known as a solid
  double edge_ = 0.0;              // [m]
  ShellRegions regions_;
  HitPlaces places_;
  ShellCover cover_;
  std::shared_ptr<const ToolSurface> surface_;
  ShellCells cells_;
  SearchedPlaces searched_;
  double since_far_look_ = 1.0;  // [m] way of the tool, at most
  ProbeHits hits_;
  std::size_t cutting_hits_ = 0;  // hits of cutting points come first; this is their number
  HoldSolver solver_;
  FlankFriction flanks_;
  ContactAdditions added_;    // of this step
  bool constrained_ = false;  // the solver may hold planes of added constraints
  TangentialStep slip_;       // bone frame
  TangentialHold tangential_;
  Pose bone_from_tool_;
  Vec3 engaged_{0.0};         // [m] bone frame: offset from the tool's pose to the proxy pose
  HoldMove since_look_;       // move of the tool since gaps were measured; engagement: its increase
  double clearance_ = 0.0;    // [m]
  Vec3 push_{0.0, 0.0, 1.0};  // unit, tool frame: opposite to the thrust
  Pose world_from_bone_;
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  bool spinning_ = false;      // in the last step
  double lying_ = 0.0;         // [voxels] overlap of a stopped tool with its hole, see Stopped
  bool stop_unseen_ = false;   // the spin has ended, and bone was not read since
  Vec3 engaged_at_stop_{0.0};  // [m] bone frame
  bool placed_ = false;        // the frames above are from the last step
  HoldForce hold_force_;       // world frame
  FeltHardness felt_;
  double coupling_ = 0.0;  // [N/m] in this step
  ConstrainedToolState state_;
};

}  // namespace burrhole
