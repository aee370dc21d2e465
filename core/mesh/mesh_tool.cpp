#include "core/mesh/mesh_tool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/rotation.h"
#include "core/contact/cleared_shell.h"
#include "core/contact/constraint_planes.h"
#include "core/contact/hold_force.h"
#include "core/contact/shell_cover.h"
#include "core/contact/tool_sweep.h"
#include "core/mesh/mesh_gaps.h"

namespace burrhole {
namespace {

constexpr double kClearanceRise = 4.0;   // [-] clearance over engaged depth below kClearance: first contact is at the tool's pose
constexpr std::size_t kDirections = 24;  // of planes without load that the servo gets: six sides of a cube, in quarters

/// The side of a cube and its quarter that a direction points to, 0 to 23.
std::size_t direction_of(const Vec3& v) noexcept {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(v[static_cast<int>(a)]) > std::abs(v[static_cast<int>(axis)])) axis = a;
  const auto sign = [&](std::size_t a) { return v[static_cast<int>(a % 3)] < 0.0 ? std::size_t{1} : std::size_t{0}; };
  return axis * 8 + sign(axis) * 4 + sign(axis + 1) * 2 + sign(axis + 2);
}

class MeshTool final : public ContactModel {
 public:
  MeshTool(const MeshToolConfig& config, const PointShell& shell, const ContactOptions& options)
      : config_(config),
        options_(options),
        shell_(shell),
        edge_(options.voxel_edge),
        cover_(shell.positions),
        gaps_(shell.size(), options.voxel_edge) {
    for (const Vec3& p : shell.positions) reach_ = std::max(reach_, glm::length(p));
  }

  void place(const Pose& world_from_tool) noexcept override {
    world_from_tool_ = world_from_tool;
    engaged_ = on_hand_ = Vec3(0.0);
    placed_ = false;
    solver_.clear();
    gaps_.forget();
    hold_force_.clear();
    tangential_.clear();
  }
  [[nodiscard]] std::size_t points() const noexcept override { return shell_.size(); }
  void step(const ContactInput& in, ContactState& out) noexcept override;

 private:
  class Candidates;
  struct Pull {
    Vec3 target{0.0};  // [m] world: equilibrium of spring and damper
    double stiffness = 0.0;
  };
  [[nodiscard]] Pull pull_of(const HandMotion& hand, double dt) const noexcept;
  void set_clearance() noexcept;
  /// [m] tool frame. Cutting points that face away from the push have a clearance inwards. At the edge of a tool this is also against the
  /// push: the 0.5 level rounds the corner between wall and floor, and an edge without clearance would be wedged in that rounding.
  [[nodiscard]] Vec3 position_of(std::size_t point) const noexcept {
    if (!cuts(point)) return shell_.positions[point];
    const Vec3& inward = shell_.inward_normals[point];
    const double along = glm::dot(inward, push_);
    return shell_.positions[point] + inward * (clearance_ * std::clamp((kClearedBelow - along * along) * kClearedRise, 0.0, 1.0));
  }
  [[nodiscard]] bool cuts(std::size_t point) const noexcept { return spinning_ && shell_.cutting[point] != 0; }
  [[nodiscard]] HoldPlane plane_of(const MeshGap& gap) const noexcept;
  void look(const ContactView& bone, double reach) noexcept;
  void sweep(const BoneView& bone, const Pose& bone_from_target, const Pull& pull) noexcept;
  [[nodiscard]] HoldMove solve(const Pose& bone_from_target, const Pull& pull, bool first) noexcept;
  void report(const Pose& world_from_bone, const Pull& pull, ContactState& out) noexcept;
  void describe(const BoneView& bone, double reach, LocalContact& out) noexcept;
  void stay(ContactState& out) const noexcept;

  MeshToolConfig config_;
  ContactOptions options_;
  PointShell shell_;
  double edge_;         // [m]
  double reach_ = 0.0;  // [m] of the points from the tool origin
  ShellCover cover_;
  MeshGaps gaps_;
  HoldSolver solver_;
  HoldForce hold_force_;
  TangentialHold tangential_;
  TangentialLaw* law_ = nullptr;
  TangentialStep slip_;
  ContactAdditions added_;
  Pose world_from_tool_, bone_from_tool_, world_from_bone_;
  Vec3 engaged_{0.0};         // [m] bone frame: offset from the tool's pose to the pose at which cutting points are tested
  Vec3 on_hand_{0.0};         // [N] world, of the last step
  Vec3 push_{0.0, 0.0, 1.0};  // unit, tool frame: opposite to the thrust
  double clearance_ = 0.0;    // [m]
  HoldMove since_look_;
  std::uint32_t flags_ = 0;
  bool placed_ = false, spinning_ = false;
};

/// The points near the surface as candidate planes.
class MeshTool::Candidates final : public HoldCandidates {
 public:
  explicit Candidates(const MeshTool& tool) noexcept : tool_(tool) {}
  std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                         std::span<const HoldPlane> kept) noexcept override {
    const MeshGap* worst = nullptr;
    double least = -problem.tolerance;
    const Vec3 engaging = move.engagement - problem.engaged;
    for (const MeshGap& gap : tool_.gaps_.list()) {
      const HoldPlane plane = tool_.plane_of(gap);
      const double after =
          plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, plane.arm) + (plane.cutting ? engaging : Vec3(0.0)));
      if (after >= least || std::ranges::find(kept, gap.point, &HoldPlane::point) != kept.end()) continue;
      least = after;
      worst = &gap;
    }
    return worst != nullptr ? std::optional(tool_.plane_of(*worst)) : std::nullopt;
  }

 private:
  const MeshTool& tool_;
};

MeshTool::Pull MeshTool::pull_of(const HandMotion& hand, double dt) const noexcept {
  const double damping = config_.coupling_damping / dt, stiffness = config_.coupling_stiffness + damping;
  return {(config_.coupling_stiffness * hand.world_from_hand.translation + damping * (world_from_tool_.translation + hand.velocity * dt)) /
              stiffness,
          stiffness};
}

void MeshTool::set_clearance() noexcept {
  const double engaged = spinning_ ? glm::length(engaged_) : 0.0;
  clearance_ = std::min(kClearanceRise * engaged, kClearance * edge_);
  if (engaged > 0.0) push_ = glm::conjugate(bone_from_tool_.rotation) * engaged_ / engaged;
}

HoldPlane MeshTool::plane_of(const MeshGap& gap) const noexcept {
  HoldPlane plane;
  plane.point = gap.point;
  plane.place = position_of(gap.point);
  plane.arm = bone_from_tool_.rotate(plane.place);
  plane.cutting = cuts(gap.point);
  plane.gap = gap.gap;
  plane.normal = gap.normal != Vec3(0.0) ? gap.normal : bone_from_tool_.rotate(shell_.inward_normals[gap.point]);
  plane.yield = plane.cutting ? kOwnGiveWholeVoxels / config_.cutting_stiffness : 1.0 / config_.bone_stiffness;
  return plane;
}

void MeshTool::look(const ContactView& bone, double reach) noexcept {
  gaps_.begin(bone, reach);
  for (std::uint32_t n = 0; n < shell_.size(); ++n) gaps_.probe(n, bone_from_tool_ * position_of(n) + (cuts(n) ? engaged_ : Vec3(0.0)));
}

HoldMove MeshTool::solve(const Pose& bone_from_target, const Pull& pull, bool first) noexcept {
  const bool limited = spinning_ && std::isfinite(config_.push_out);
  const double furthest_out = first ? config_.push_out / pull.stiffness : 0.0;
  solver_.refresh([&](HoldPlane& plane) {
    if (plane.point >= kConstraintPoint || plane.both_ways) return false;
    const std::size_t n = gaps_.find(plane.point);
    if (n == gaps_.list().size()) return false;
    const double force = plane.force;
    plane = plane_of(gaps_.list()[n]);
    plane.force = force;
    if (plane.cutting && limited) plane.gap = std::max(plane.gap, -furthest_out - plane.yield * force);
    return true;
  });
  if (limited) gaps_.bound(-furthest_out, [&](std::uint32_t point) { return cuts(point); });
  const HoldProblem problem{.target = bone_from_target.translation - bone_from_tool_.translation,
                            .turn = rotation_vector(bone_from_target.rotation * glm::conjugate(bone_from_tool_.rotation)),
                            .engaged = engaged_,
                            .stiffness = pull.stiffness,
                            .turn_stiffness = std::numeric_limits<double>::infinity(),
                            .cutting_stiffness = config_.cutting_stiffness / (1.0 - kOwnGiveWholeVoxels),
                            .tolerance = kPlaneTolerance * edge_};
  Candidates candidates(*this);
  ConstraintPlanes constrained(added_.constraints, world_from_bone_, bone_from_tool_, candidates);
  if (law_ == nullptr) return solver_.solve(problem, constrained);
  HoldProblem fine = problem;
  fine.tolerance *= kFineTolerance;
  return tangential_.solve(*law_, slip_, fine, constrained, solver_);
}

void MeshTool::sweep(const BoneView& bone, const Pose& bone_from_target, const Pull& pull) noexcept {
  HoldMove last;
  double relaxation = 1.0;
  bool at_rest = false;
  for (int moves = 0; !at_rest && moves < config_.max_moves; ++moves) {
    look(bone.voxels, kLookAhead * edge_);
    if (gaps_.outside() &&
        (bone.coarse == nullptr || cover_.reaches_unread(bone.voxels, *bone.coarse, bone.world_from_bone * bone_from_tool_))) {
      flags_ |= kContactOutsideWindow;
      bone_from_tool_.translation -= since_look_.translation;
      return;
    }
    const HoldMove move = solve(bone_from_target, pull, moves == 0);
    if (!solver_.converged()) flags_ |= kContactUnsettled;
    const Vec3 engaging = move.engagement - engaged_;
    const double length =
        std::max(glm::length(move.translation), glm::length(move.translation + engaging)) + glm::length(move.turn) * reach_;
    const double free = std::max(kLongestMove * edge_, gaps_.nearest() - kLookAhead * edge_);
    if (glm::dot(move.translation, last.translation) + glm::dot(engaging, last.engagement) +
            reach_ * reach_ * glm::dot(move.turn, last.turn) <
        0.0)
      relaxation = std::max(0.125, 0.5 * relaxation);
    const double part = std::min(relaxation, length > free ? free / length : 1.0);
    bone_from_tool_.translation += move.translation * part;
    bone_from_tool_.rotation = glm::normalize(rotation_of(move.turn * part) * bone_from_tool_.rotation);
    engaged_ += engaging * part;
    since_look_ = {move.translation * part, move.turn * part, engaging * part};
    slip_.moved.translation += since_look_.translation;
    slip_.moved.turn += since_look_.turn;
    last = {move.translation, move.turn, engaging};
    at_rest = length <= kSettled * edge_ || (relaxation <= 0.25 && length <= 4.0 * kSettled * edge_);
  }
  if (!at_rest) flags_ |= kContactUnsettled;
}

void MeshTool::report(const Pose& world_from_bone, const Pull& pull, ContactState& out) noexcept {
  world_from_tool_ = world_from_bone * bone_from_tool_;
  Vec3 cutting(0.0);
  out.on_hand = {};
  for (const HoldPlane& plane : solver_.planes()) {
    const Vec3 force = world_from_bone.rotate(plane.normal * plane.force);
    out.on_hand.force += force;
    if (plane.cutting) cutting += force;
    out.on_hand.torque += glm::cross(world_from_bone.rotate(plane.arm), force);
  }
  if (law_ != nullptr) {
    out.local.tangential = {world_from_bone.rotate(tangential_.on_tool().force), world_from_bone.rotate(tangential_.on_tool().torque)};
    out.on_hand.force += out.local.tangential.force;
    out.on_hand.torque += out.local.tangential.torque;
  }
  out.cutting_force = glm::length(cutting);
  if ((flags_ & kContactOutsideWindow) != 0) {
    out.on_hand = {hold_force_.of(pull.stiffness * (world_from_tool_.translation - pull.target)), Vec3(0.0)};
    out.cutting_force = 0.0;
  } else {
    hold_force_.note(out.on_hand.force);
  }
  out.engagement = out.cutting_force / config_.cutting_stiffness;
  out.world_from_tool = world_from_tool_;
  on_hand_ = out.on_hand.force;
}

void MeshTool::describe(const BoneView& bone, double reach, LocalContact& out) noexcept {
  if (flags_ & kContactOutsideWindow) return;
  out.kind = LocalKind::coupled;
  out.engaged = bone.world_from_bone.rotate(engaged_);
  out.coupling_stiffness = config_.coupling_stiffness;
  out.coupling_damping = config_.coupling_damping;
  out.turn_stiffness = std::numeric_limits<double>::infinity();
  out.cutting_stiffness = config_.cutting_stiffness;
  out.spin = bone.world_from_bone.rotate(slip_.spin);
  const auto list = [&](HoldPlane plane) {
    if (out.count == kMaxLocalPlanes) return;
    plane.gap += glm::dot(plane.normal, since_look_.translation + glm::cross(since_look_.turn, plane.arm) +
                                            (plane.cutting ? since_look_.engagement : Vec3(0.0)));
    if (plane.cutting && plane.force == 0.0) plane.gap = std::max(plane.gap, 0.0);
    plane.normal = bone.world_from_bone.rotate(plane.normal);
    plane.arm = bone.world_from_bone.rotate(plane.arm);
    out.planes[out.count++] = plane;
  };
  for (const HoldPlane& plane : solver_.planes()) list(plane);
  if (reach > kLookAhead * edge_) {
    look(bone.voxels, reach);
    since_look_ = {};
  }
  std::array<const MeshGap*, kDirections> near{};
  for (const MeshGap& gap : gaps_.list()) {
    if (std::ranges::find(solver_.planes(), gap.point, &HoldPlane::point) != solver_.planes().end()) continue;
    const MeshGap*& best = near[direction_of(shell_.inward_normals[gap.point])];
    if (best == nullptr || gap.gap < best->gap) best = &gap;
  }
  for (const MeshGap* gap : near)
    if (gap != nullptr) list(plane_of(*gap));
}

void MeshTool::stay(ContactState& out) const noexcept {
  out.world_from_tool = world_from_tool_;
  out.on_hand = {};
  out.engagement = out.cutting_force = 0.0;
  out.force_gradient = Mat3(0.0);
}

void MeshTool::step(const ContactInput& in, ContactState& out) noexcept {
  const Pose& hand = in.hand.world_from_hand;
  const Quat& turn = hand.rotation;
  out.world_from_hand = hand;
  out.local = {};
  flags_ = 0;
  if (!is_finite(hand.translation) || !is_finite(in.hand.velocity) || !std::isfinite(turn.w + turn.x + turn.y + turn.z)) {
    out.flags = kContactNotFinite;
    return stay(out);
  }
  if (in.bone.voxels.triangles() == nullptr) {
    out.flags = kContactOutsideWindow;  // nothing has been published
    return stay(out);
  }
  if (in.added.tangential != nullptr && (law_ != in.added.tangential || !placed_)) {
    in.added.tangential->clear();
    tangential_.clear();
  }
  law_ = in.added.tangential;
  added_ = in.added;
  if (!placed_) world_from_bone_ = in.bone.world_from_bone;
  placed_ = true;
  bone_from_tool_ = world_from_bone_.inverse() * world_from_tool_;  // moves with a bone that moved
  world_from_bone_ = in.bone.world_from_bone;
  world_from_tool_ = world_from_bone_ * bone_from_tool_;
  spinning_ = in.spin.spinning;
  if (!spinning_) engaged_ = Vec3(0.0);
  set_clearance();
  slip_ = {.moved = {}, .spin = bone_from_tool_.rotate(Vec3(0.0, 0.0, in.spin.rate)), .dt = in.dt};
  since_look_ = {};
  const Pull pull = pull_of(in.hand, in.dt);
  const Pose bone_from_world = world_from_bone_.inverse();
  const Pose bone_from_target = bone_from_world * Pose{hand.rotation, pull.target};
  sweep(in.bone, bone_from_target, pull);
  if (spinning_)
    suppress_reversal({.solver = solver_,
                       .tangential = tangential_,
                       .law = law_,
                       .position = bone_from_tool_.translation,
                       .since_look = since_look_,
                       .engaged = engaged_},
                      bone_from_target.translation, bone_from_world.rotate(on_hand_), edge_);
  report(world_from_bone_, pull, out);
  out.flags = flags_;
  if (options_.planes) {
    describe(in.bone, glm::length(in.hand.velocity) * options_.foresight, out.local);
    out.force_gradient = force_gradient(out.local);
  }
  if ((flags_ & kContactOutsideWindow) != 0) out.force_gradient = Mat3(out.on_hand.force != Vec3(0.0) ? -config_.coupling_stiffness : 0.0);
  if (law_ != nullptr) law_->end_step((flags_ & (kContactUnsettled | kContactOutsideWindow)) == 0 ? slip_.moved : tangential_.move());
  added_ = {};  // its span is valid for the step only
}

}  // namespace

Result<std::unique_ptr<ContactModel>> make_mesh_tool(const MeshToolConfig& config, const PointShell& shell, const ContactOptions& options) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  for (const double value : {config.coupling_stiffness, config.cutting_stiffness, config.bone_stiffness, options.voxel_edge})
    if (!(std::isfinite(value) && value > 0.0))
      return refuse("coupling, cutting and bone stiffness and the voxel's edge must be finite and above 0");
  if (!(config.coupling_damping >= 0.0 && std::isfinite(config.coupling_damping)))
    return refuse("coupling damping must be finite and at least 0");
  if (!(config.push_out >= 0.0)) return refuse("the force that pushes cutting points out of bone must be at least 0");
  if (config.max_moves < 1) return refuse("there must be at least one move in a step");
  if (shell.size() == 0 || shell.size() > kMaxShellPoints) return refuse("the point shell must hold 1 to 200000 points");
  if (shell.inward_normals.size() != shell.size() || shell.cutting.size() != shell.size())
    return refuse("each point of the shell needs an inward normal and whether it cuts");
  return std::unique_ptr<ContactModel>(std::make_unique<MeshTool>(config, shell, options));
}

}  // namespace burrhole
