#include "core/contact/constrained_tool.h"

#include <cmath>

#include "core/base/rotation.h"
#include "core/contact/conforming_normal.h"
#include "core/contact/distance_slope.h"
#include "core/contact/tool_candidates.h"
#include "core/contact/tool_sweep.h"

namespace burrhole {
namespace {

constexpr double kFarthestLook = kRecordBand - 1.0;  // [voxel edges] all eight records around a point hold their distance up to here
constexpr float kLeastStiffness = 0.1f;              // [-] relative: voxels at a face are partly bone, and the compliance must stay bounded
constexpr double kOwnGive = 0.02;                    // [-] as kOwnGiveWholeVoxels, where the cutting part is known as a solid
constexpr std::size_t kFlankPoints = 1200;           // enough to sample the lateral stiffness; every shipped bit has fewer cutting points
constexpr double kSameFace = 0.94;                   // [-] cosine of 20 degrees: two directions within this angle belong to one face
constexpr double kFacing = 0.0;                      // [-] cosine: least agreement of the faces of tool and bone in contact
constexpr double kNewClearance = 0.01;               // [-] change of the push's direction from which the points are moved again

Affine moved(Affine affine, const Vec3& by) noexcept {
  affine.offset += by;
  return affine;
}

/// [m] Centre of the shell's bounding box. Points are stored relative to it in single precision, so a distant tool origin costs no
/// accuracy.
Vec3 middle_of(const PointShell& shell) noexcept {
  Vec3 lo = shell.positions.front(), hi = lo;
  for (const Vec3& p : shell.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  return 0.5 * (lo + hi);
}

PointShell about(PointShell shell, const Vec3& middle) {
  for (Vec3& p : shell.positions) p -= middle;
  return shell;
}

/// The normal of a loaded plane that does not cut: the gradient of the distances around it, where the records' own normal roughly agrees.
/// Where it does not, two faces are near and the record's normal selects one. Planes that cut keep the records' normals: these have less
/// lateral support, and on a cutting front narrower than four voxels the wider support would tip the bit off it.
Vec3 steadied(const SurfaceView& bone, const Vec3& bone_point, const Vec3& normal) noexcept {
  const auto slope = distance_slope(bone.records, bone.records.bone_from_index.inverse() * bone_point);
  return slope && glm::dot(*slope, normal) >= kSameFace ? *slope : normal;
}

}  // namespace

ConstrainedTool::ConstrainedTool(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge,
                                 ConstrainedToolParts parts)
    : config_(config),
      shell_(shell),
      middle_(middle_of(shell)),
      points_(make_contact_shell(about(shell, middle_), voxel_edge)),
      flank_points_(even_part(points_.cutting, kFlankPoints)),
      facing_(shell, flank_points_),
      cleared_(shell, points_.cutting, middle_),
      lens_(shell, std::move(parts.cutting), voxel_edge),
      edge_(voxel_edge),
      regions_(shell),
      places_(points_),
      cover_(shell.positions),
      surface_(std::move(parts.surface)),
      felt_(config.felt_hardness),
      coupling_(config.coupling_stiffness) {
  if (surface_) cells_ = ShellCells(shell_, *surface_, edge_);
  hits_.reserve(shell_.size());
}

Result<ConstrainedTool> ConstrainedTool::create(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge,
                                                ConstrainedToolParts parts) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(std::isfinite(config.flank_friction) && config.flank_friction >= 0.0))
    return refuse("the share of the lateral stiffness must be finite and at least 0");
  if (!(config.felt_hardness >= 0.0 && config.felt_hardness < 1.0)) return refuse("the share of hardness that is felt must be in [0, 1)");
  for (const double value : {config.coupling_stiffness, config.cutting_stiffness, config.bone_stiffness, voxel_edge})
    if (!(std::isfinite(value) && value > 0.0))
      return refuse("coupling, cutting and bone stiffness and the voxel's edge must be finite and above 0");
  if (!(config.push_out >= 0.0)) return refuse("the force that pushes cutting points out of bone must be at least 0");
  if (!(config.turn_stiffness > 0.0)) return refuse("the coupling's stiffness against turning must be above 0");
  if (!(config.coupling_damping >= 0.0 && std::isfinite(config.coupling_damping)))
    return refuse("coupling damping must be finite and at least 0");
  if (config.max_moves < 1) return refuse("there must be at least one move in a step");
  if (shell.size() == 0 || shell.size() > kMaxShellPoints) return refuse("the point shell must hold 1 to 200000 points");
  if (shell.inward_normals.size() != shell.size() || shell.cutting.size() != shell.size())
    return refuse("each point of the shell needs an inward normal and whether it cuts");
  return ConstrainedTool(config, shell, voxel_edge, std::move(parts));
}

void ConstrainedTool::place(const Pose& world_from_tool) noexcept {
  state_ = {};
  state_.world_from_tool = world_from_tool;
  engaged_ = Vec3(0.0);
  solver_.clear();
  forget_places();
  flanks_.clear();
  hold_force_.clear();
  felt_ = FeltHardness(config_.felt_hardness);
  coupling_ = config_.coupling_stiffness;
  lying_ = 0.0;
  stop_unseen_ = spinning_ = placed_ = false;
}

ConstrainedTool::Pull ConstrainedTool::pull_of(const HandMotion& hand, double dt) const noexcept {
  const Pose& before = state_.world_from_tool;
  const double damping = config_.coupling_damping / dt;
  Pull pull;
  pull.stiffness = coupling_ + damping;
  // K (h - t) + B (h' - (t - t_before) / dt) is zero at the target.
  pull.world_from_target.translation =
      (coupling_ * hand.world_from_hand.translation + damping * (before.translation + hand.velocity * dt)) / pull.stiffness;
  // Rotation likewise, with the same time constant; the hand's rotation in this period gives its rate.
  const double share = config_.coupling_stiffness / (config_.coupling_stiffness + damping);
  pull.turn_stiffness = config_.turn_stiffness / share;
  const Vec3 whole = rotation_vector(hand.world_from_hand.rotation * glm::conjugate(before.rotation));
  const Vec3 hands = rotation_vector(hand.world_from_hand.rotation * glm::conjugate(hand_before_));
  const Vec3 turn = std::isinf(config_.turn_stiffness) ? whole : share * whole + (1.0 - share) * hands;
  pull.world_from_target.rotation = glm::normalize(rotation_of(turn) * before.rotation);
  return pull;
}

Vec3 ConstrainedTool::cleared(std::size_t point) const noexcept {
  if (clearance_ == 0.0 || shell_.cutting[point] == 0) return shell_.positions[point];
  if (lens_.active()) return lens_.at(point);
  return burrhole::cleared(shell_.positions[point], shell_.inward_normals[point], push_, clearance_);
}

Vec3 ConstrainedTool::cutting_normal(std::size_t point, const Vec3& bone_normal) const noexcept {
  if (!lens_.active() || !lens_.smooth(point)) return bone_normal;
  const Vec3 own = bone_from_tool_.rotate(shell_.inward_normals[point]);
  return glm::dot(own, bone_normal) > kFacing ? own : bone_normal;
}

double ConstrainedTool::own_give() const noexcept { return lens_.active() ? kOwnGive : kOwnGiveWholeVoxels; }

double ConstrainedTool::yield_of(const SurfaceView& bone, const HoldPlane& plane, const Vec3& position) const noexcept {
  if (plane.cutting) return own_give() / config_.cutting_stiffness;
  float stiffness = 1.0f;
  const Vec3i v = voxel_of(bone.records.bone_from_index.inverse() * (position - plane.normal * (plane.gap + 0.5 * edge_)));
  if (bone.stiffness != nullptr && bone.records.box.contains(v))
    stiffness = static_cast<float>(bone.stiffness[bone.records.box.offset_of(v)]) / 255.0f;
  return 1.0 / (config_.bone_stiffness * static_cast<double>(std::max(stiffness, kLeastStiffness)));
}

void ConstrainedTool::set_clearance(bool spinning) noexcept {
  const double engaged = spinning ? glm::length(engaged_) : 0.0;
  // The clearance grows with the engagement, so that first contact is at the tool's pose.
  const double clearance = lens_.active() ? engaged : std::min(engaged, kClearance * edge_);
  const Vec3 push = engaged > 0.0 ? glm::conjugate(bone_from_tool_.rotation) * engaged_ / engaged : push_;
  if (std::abs(clearance - clearance_) < kNewClearance * edge_ && glm::length(push - push_) < kNewClearance &&
      (clearance > 0.0) == (clearance_ > 0.0))
    return;
  clearance_ = clearance;
  push_ = push;
  if (lens_.active()) {
    lens_.engage(push_ * clearance_);
    lens_.draw(middle_, points_.cutting);
  } else {
    cleared_.draw(push_, clearance_, points_.cutting);
  }
  if (flank_points_.size() < points_.cutting.size()) copy_even_part(points_.cutting, kFlankPoints, flank_points_);
}

void ConstrainedTool::measure_flanks(const SurfaceView& bone, bool spinning) noexcept {
  if (!spinning || config_.flank_friction == 0.0 || engaged_ == Vec3(0.0)) {
    flanks_.clear();
    return;
  }
  hits_.clear(false);
  const Vec3 push = glm::conjugate(bone_from_tool_.rotation) * (engaged_ / glm::length(engaged_));
  const ContactShellPart& asked = flank_points_.size() < points_.cutting.size() ? flank_points_ : points_.cutting;
  probe_surface(bone.records, facing_.pick(asked, push, FlankFriction::kLeastFacing),
                bone.records.bone_from_index.inverse() * Affine::from_pose({bone_from_tool_.rotation, bone_from_tool_ * middle_}), 0.0,
                hits_);
  flanks_.look(hits_, shell_, bone_from_tool_, engaged_, config_.flank_friction * config_.cutting_stiffness);
}

void ConstrainedTool::look(const SurfaceView& bone, bool spinning, double look_ahead) noexcept {
  const Affine index_from_tool =
      bone.records.bone_from_index.inverse() * Affine::from_pose({bone_from_tool_.rotation, bone_from_tool_ * middle_});
  const Vec3 back = spinning ? bone.records.bone_from_index.inverse().linear * engaged_ : Vec3(0.0);
  hits_.clear(shell_.size() > kScannedHits);
  const bool between = follows_surface(spinning), far = between && far_look_due();
  const auto reach = [&](double cells) { return far ? std::max(look_ahead, std::min(cells, kFarthestLook)) : look_ahead; };
  probe_surface(bone.records, points_.cutting, moved(index_from_tool, back), reach(cells_.reach_of_cutting()), hits_);
  cutting_hits_ = hits_.count;
  probe_surface(bone.records, points_.passive, index_from_tool, reach(cells_.reach_of_passive()), hits_);
  if (between) look_between(bone, far);
}

void ConstrainedTool::let_lie(double furthest_out) noexcept {
  solver_.refresh([&](HoldPlane& plane) {
    if (plane.cutting) plane.gap = std::max(plane.gap, -furthest_out - plane.yield * plane.force);
    return true;
  });
  const auto least = static_cast<float>(-furthest_out / edge_);
  for (std::size_t n = 0; n < cutting_hits_; ++n) hits_.distance[n] = std::max(hits_.distance[n], least);
}

HoldMove ConstrainedTool::solve(const SurfaceView& bone, const Pose& bone_from_target, const Pull& pull, bool spinning) noexcept {
  const Affine index_from_bone = bone.records.bone_from_index.inverse();
  const RecordSampler records(bone.records);
  const bool between = follows_surface(spinning);
  const PlaceFinder finder(surface_.get(), bone.records, bone_from_tool_);
  if (constrained_) solver_.refresh([](const HoldPlane& plane) { return plane.point < kConstraintPoint || plane.both_ways; });
  solver_.refresh([&](HoldPlane& plane) {
    if (plane.both_ways) return false;  // added again below
    if (between) return settle_kept(bone, finder, plane);
    plane.arm = bone_from_tool_.rotate(cleared(plane.point));
    plane.cutting = spinning && shell_.cutting[plane.point] != 0;
    const Vec3 position = bone_from_tool_.translation + plane.arm + (plane.cutting ? engaged_ : Vec3(0.0));
    const auto sample = records.at(index_from_bone * position);
    if (!sample || sample->distance > kLookAhead || sample->normal == Vec3(0.0)) return false;
    plane.gap = sample->distance * edge_;
    plane.normal = plane.cutting ? cutting_normal(plane.point, sample->normal) : direction(bone, plane, position, sample->normal, spinning);
    plane.yield = yield_of(bone, plane, position);
    return true;
  });
  const HoldProblem problem{.target = bone_from_target.translation - bone_from_tool_.translation,
                            .turn = rotation_vector(bone_from_target.rotation * glm::conjugate(bone_from_tool_.rotation)),
                            .engaged = engaged_,
                            .stiffness = pull.stiffness,
                            .turn_stiffness = pull.turn_stiffness,
                            .cutting_stiffness = config_.cutting_stiffness / (1.0 - own_give()),
                            .tolerance = kPlaneTolerance * edge_};
  // Bone is at rest within a sweep, so only the first move corrects penetration. Later penetration comes from planes that only approximate
  // the surface.
  if (spinning && std::isfinite(config_.push_out)) let_lie(state_.moves == 0 ? config_.push_out / pull.stiffness : 0.0);
  for (const HoldPlane& plane : flanks_.planes(bone_from_tool_))
    if (plane.yield > 0.0) solver_.add(plane);
  Candidates candidates(*this, bone, spinning);
  if (added_.constraints.empty() && added_.tangential == nullptr) return solver_.solve(problem, candidates);
  return solve_with(bone, problem, candidates);
}

Vec3 ConstrainedTool::direction(const SurfaceView& bone, const HoldPlane& plane, const Vec3& position, const Vec3& normal,
                                bool spinning) const noexcept {
  return conforming_normal(hits_, {spinning ? cutting_hits_ : 0, hits_.count},
                           {.place = (follows_surface(spinning) ? plane.place : shell_.positions[plane.point]) - middle_,
                            .gap = plane.gap / edge_,
                            .normal = normal,
                            .steadied = steadied(bone, position, normal)},
                           glm::mat3_cast(bone_from_tool_.rotation), edge_);
}

void ConstrainedTool::apply(const HoldMove& move, double part) noexcept {
  bone_from_tool_.translation += move.translation * part;
  bone_from_tool_.rotation = glm::normalize(rotation_of(move.turn * part) * bone_from_tool_.rotation);
  engaged_ += (move.engagement - engaged_) * part;
  since_far_look_ += part * (glm::length(move.translation) + glm::length(move.turn) * (points_.reach + glm::length(middle_)));
  if (added_.tangential == nullptr) return;
  slip_.moved.translation += move.translation * part;
  slip_.moved.turn += move.turn * part;
}

void ConstrainedTool::sweep(const SurfaceView& bone, const Pull& pull, bool spinning) noexcept {
  const Pose bone_from_target = bone.world_from_bone.inverse() * pull.world_from_target;
  HoldMove last;
  Pose known = bone_from_tool_;  // the pose of the last probe
  Vec3 known_engaged = engaged_;
  double relaxation = 1.0;
  state_.moves = 0;
  bool at_rest = false;
  for (; !at_rest && state_.moves < static_cast<std::uint32_t>(config_.max_moves); ++state_.moves) {
    look(bone, spinning, kLookAhead);
    if (hits_.outside) {
      if (const double free = free_distance(bone); free > 0.0) {
        at_rest = move_freely(bone_from_target, free);
        last = {};
        known = bone_from_tool_;
        known_engaged = engaged_;
        continue;
      }
      state_.flags |= kContactOutsideWindow;
      bone_from_tool_ = known;
      engaged_ = known_engaged;
      return;
    }
    known = bone_from_tool_;
    known_engaged = engaged_;
    const HoldMove move = solve(bone, bone_from_target, pull, spinning);
    if (!solver_.converged()) state_.flags |= kContactUnsettled;
    const Vec3 engaging = move.engagement - engaged_;
    const double turned = glm::length(move.turn) * (points_.reach + glm::length(middle_));
    const double length = std::max(glm::length(move.translation), glm::length(move.translation + engaging)) + turned;
    // Where nothing is near, the path is free up to the nearest point of bone.
    const double free = std::max(kLongestMove, static_cast<double>(hits_.nearest) - kLookAhead) * edge_;
    // Planes found at successive poses may differ slightly; a reversal means that the solution lies between them.
    const double lever = points_.reach * points_.reach;
    if (glm::dot(move.translation, last.translation) + glm::dot(engaging, last.engagement) + lever * glm::dot(move.turn, last.turn) < 0.0)
      relaxation = std::max(0.125, 0.5 * relaxation);
    const double part = std::min(relaxation, length > free ? free / length : 1.0);
    apply(move, part);
    since_look_ = {move.translation * part, move.turn * part, engaging * part};
    last = {move.translation, move.turn, engaging};
    at_rest = length <= kSettled * edge_ || (relaxation <= 0.25 && length <= 4.0 * kSettled * edge_);
  }
  if (!at_rest) state_.flags |= kContactUnsettled;
}

void ConstrainedTool::report(const SurfaceView& bone) noexcept {
  state_.world_from_tool = bone.world_from_bone * bone_from_tool_;
  Vec3 cutting(0.0);
  state_.on_hand = {};
  for (const HoldPlane& plane : solver_.planes()) {
    const Vec3 force = bone.world_from_bone.rotate(plane.normal * plane.force);
    state_.on_hand.force += force;
    if (plane.cutting) cutting += force;
    state_.on_hand.torque += glm::cross(bone.world_from_bone.rotate(plane.arm), force);
  }
  if (added_.tangential != nullptr) {
    state_.tangential = {bone.world_from_bone.rotate(tangential_.on_tool().force),
                         bone.world_from_bone.rotate(tangential_.on_tool().torque)};
    state_.on_hand.force += state_.tangential.force;
    state_.on_hand.torque += state_.tangential.torque;
  }
  state_.cutting_force = glm::length(cutting);
  state_.engagement = state_.cutting_force / config_.cutting_stiffness;
  flanks_.settle(bone_from_tool_, engaged_, state_.cutting_force);
  state_.aside = bone.world_from_bone.rotate(flanks_.aside());
}

void ConstrainedTool::describe(const SurfaceView& whole, double reach, LocalContact& out) noexcept {
  const SurfaceView bone = lying_in(whole);
  out.count = 0;
  out.kind = LocalKind::none;
  if ((state_.flags & (kContactOutsideWindow | kContactNotFinite)) != 0) return;
  out.kind = LocalKind::coupled;
  out.engaged = bone.world_from_bone.rotate(engaged_);
  out.coupling_stiffness = coupling_;
  out.coupling_damping = config_.coupling_damping;
  out.turn_stiffness = config_.turn_stiffness;
  out.cutting_stiffness = config_.cutting_stiffness;
  out.tangential = state_.tangential;
  out.spin = bone.world_from_bone.rotate(slip_.spin);
  const auto list = [&](HoldPlane plane) {
    if (out.count == kMaxLocalPlanes) return;
    plane.gap += glm::dot(plane.normal, since_look_.translation + glm::cross(since_look_.turn, plane.arm) +
                                            (plane.cutting ? since_look_.engagement : Vec3(0.0)));
    if (plane.cutting && plane.force == 0.0) plane.gap = std::max(plane.gap, 0.0);  // no force outwards, as in let_lie()
    plane.normal = bone.world_from_bone.rotate(plane.normal);
    plane.arm = bone.world_from_bone.rotate(plane.arm);
    out.planes[out.count++] = plane;
  };
  for (const HoldPlane& plane : solver_.planes()) list(plane);
  if (reach > kLookAhead * edge_) {
    look(bone, spinning_, std::min(reach / edge_, kFarthestLook));
    since_look_ = {};
  }
  std::array<std::uint32_t, kMaxRegions> near;
  regions_.pick(hits_, near);
  const Candidates candidates(*this, bone, spinning_);
  for (const std::uint32_t hit : near)
    if (hit != kNoHit && std::ranges::find(solver_.planes(), hits_.point[hit], &HoldPlane::point) == solver_.planes().end())
      list(candidates.plane_of(hit));
}

const ConstrainedToolState& ConstrainedTool::step(const SurfaceView& bone, const HandMotion& hand, double dt, const ToolSpin& spin,
                                                  const ContactAdditions& added) noexcept {
  state_.flags = 0;
  const Quat& turn = hand.world_from_hand.rotation;
  if (!is_finite(hand.world_from_hand.translation) || !is_finite(hand.velocity) || !std::isfinite(turn.w + turn.x + turn.y + turn.z)) {
    // A motion that is not finite gives no force and cuts nothing; the tool stays in place.
    const Pose stays = state_.world_from_tool;
    state_ = {};
    state_.world_from_tool = stays;
    state_.flags = kContactNotFinite;
    return state_;
  }
  const bool placed = placed_;
  if (!placed_) {
    world_from_bone_ = bone.world_from_bone;
    hand_before_ = hand.world_from_hand.rotation;
    placed_ = true;
  }
  bone_from_tool_ = world_from_bone_.inverse() * state_.world_from_tool;  // moves with a bone that moved
  if (bone.world_from_bone.translation != world_from_bone_.translation || bone.world_from_bone.rotation != world_from_bone_.rotation)
    since_far_look_ = 1.0;
  begin_added(added, spin.rate, dt, placed);
  const Vec3 from = bone_from_tool_.translation + engaged_;
  const Pull pull = pull_of(hand, dt);
  const bool was_spinning = spinning_;
  spinning_ = spin.spinning;
  let_overlap_lie(bone, was_spinning);
  set_clearance(spinning_);
  measure_flanks(bone, spinning_);
  const Vec3 before = bone.world_from_bone.inverse().rotate(state_.on_hand.force);
  sweep(lying_in(bone), pull, spinning_);
  if (spinning_)
    suppress_reversal({.solver = solver_,
                       .tangential = tangential_,
                       .law = added_.tangential,
                       .position = bone_from_tool_.translation,
                       .since_look = since_look_,
                       .engaged = engaged_},
                      (bone.world_from_bone.inverse() * pull.world_from_target).translation, before, edge_);
  report(bone);
  if ((state_.flags & kContactOutsideWindow) != 0)
    hold(pull);
  else
    hold_force_.note(state_.on_hand.force);
  end_added();
  if (felt_.active()) feel_hardness(bone, from, dt);
  world_from_bone_ = bone.world_from_bone;
  hand_before_ = hand.world_from_hand.rotation;
  return state_;
}

}  // namespace burrhole
