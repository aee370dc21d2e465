#include "core/contact/constrained_tool.h"

#include <cmath>

namespace burrhole {
namespace {

// Normals closer than this share a plane slot (about 8 degrees): the more binding one stays; the rest is met in the next move.
constexpr double kSameDirection = 0.99;
constexpr double kLookEvery = 0.75;  // [voxels] between looks for bone behind a point: under the thinnest layer that is felt
constexpr int kMostLooks = 32;

/// The model says which points touch; the depth is taken to the 0.5 surface, at sub-voxel precision. First along the tool vector, behind
/// which the tool has made room; where that way is long (the vector runs just under the surface) along the model's normal if that is
/// shorter. A normal against the tool vector leads out on the far side of a thin wall: following it would push the tool through.
std::optional<SurfacePoint> way_out(const ContactView& bone, const Contact& contact, const Vec3& inward) noexcept {
  const double near = 3.0 * bone.voxel_edge(), far = 12.0 * bone.voxel_edge();
  if (auto surface = bone.leave_bone(contact.position, inward, near)) return surface;
  if (glm::dot(contact.normal, inward) > 0.1)
    if (auto surface = bone.leave_bone(contact.position, contact.normal, far)) return surface;
  return bone.leave_bone(contact.position, inward, far);
}

}  // namespace

ConstrainedTool::ConstrainedTool(const ConstrainedToolConfig& config, const PointShell& shell, double margin,
                                 std::unique_ptr<ContactModel> detector)
    : config_(config), shell_(shell), margin_(margin), detector_(std::move(detector)) {
  contacts_.contacts.reserve(shell_.size());
  held_.assign(shell_.size(), kFree);
}

Result<ConstrainedTool> ConstrainedTool::create(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge,
                                                const void* context, ModelFactory make_model) {
  for (const double value : {config.coupling_stiffness, config.cutting_stiffness, voxel_edge})
    if (!(std::isfinite(value) && value > 0.0))
      return Error{ErrorCode::out_of_range, "coupling and cutting stiffness must be finite and above 0", {}};
  if (!(config.coupling_damping >= 0.0) || config.max_moves < 1)
    return Error{ErrorCode::out_of_range, "coupling damping must be at least 0", {}};
  const double margin = 0.5 * voxel_edge;
  PointShell grown = shell;
  for (std::size_t n = 0; n < grown.size(); ++n) grown.positions[n] -= grown.inward_normals[n] * margin;
  auto detector = make_model(context, std::move(grown));
  if (!detector) return detector.error();
  return ConstrainedTool(config, shell, margin, std::move(detector).value());
}

void ConstrainedTool::place(const Pose& world_from_tool) noexcept {
  state_ = {};
  state_.world_from_tool = world_from_tool;
  plane_count_ = 0;
  held_.assign(held_.size(), kFree);
}

void ConstrainedTool::add_plane(const HoldPlane& plane, const Vec3& arm) noexcept {
  std::size_t least = 0;
  for (std::size_t n = 0; n < plane_count_; ++n) {
    if (planes_[n].cutting == plane.cutting && glm::dot(planes_[n].normal, plane.normal) > kSameDirection) {
      if (plane.offset > planes_[n].offset) {
        planes_[n] = plane;
        arms_[n] = arm;
      }
      return;
    }
    if (planes_[n].offset < planes_[least].offset) least = n;
  }
  if (plane_count_ < kMaxHoldPlanes) {
    planes_[plane_count_] = plane;
    arms_[plane_count_++] = arm;
  } else if (plane.offset > planes_[least].offset) {
    planes_[least] = plane;
    arms_[least] = arm;
  }
}

void ConstrainedTool::add_bone_behind(const ContactView& bone, const Pose& pose) noexcept {
  // A point can only have bone behind it if it was held a moment ago: moves are shorter than half a voxel.
  const double edge = bone.voxel_edge();
  // As deep as the tool may be engaged, and two voxels more.
  const int looks = std::min(kMostLooks, static_cast<int>(std::ceil((state_.engagement / edge + 2.0) / kLookEvery)));
  for (const Contact& contact : contacts_.contacts) held_[contact.point] = kTouching;
  for (std::size_t n = 0; n < shell_.size(); ++n) {
    if (held_[n] == kTouching) {
      held_[n] = kHeld;
      continue;
    }
    if (held_[n] == kFree) continue;
    held_[n] = kFree;
    if (shell_.cutting[n] == 0) continue;
    const Vec3 inward = pose.rotate(shell_.inward_normals[n]);
    const Vec3 probe = pose * shell_.positions[n] - inward * margin_;
    for (int look = 1; look <= looks; ++look) {
      const Vec3 inside = probe + inward * (kLookEvery * look * edge);
      if (bone.sample(bone.index_of(inside)) < kSurfaceLevel) continue;
      contacts_.contacts.push_back({static_cast<std::uint32_t>(n), inside, inside, inward, 0.0});
      held_[n] = kHeld;
      break;
    }
  }
}

void ConstrainedTool::find_planes(const ContactView& bone, const Pose& pose, bool spinning) noexcept {
  detector_->evaluate(bone, pose, contacts_);
  state_.flags |= contacts_.flags;
  add_bone_behind(bone, pose);
  plane_count_ = 0;
  deepest_ = 0.0;
  for (const Contact& contact : contacts_.contacts) {
    const Vec3 arm = pose.rotate(shell_.positions[contact.point]);
    const Vec3 position = pose.translation + arm;
    const Vec3 inward = pose.rotate(shell_.inward_normals[contact.point]);
    Vec3 normal = contact.normal;
    double depth = glm::dot(contact.plane_point - position, normal);
    if (const auto surface = way_out(bone, contact, inward)) {
      normal = surface->normal;
      depth = glm::dot(surface->position - position, normal);
    }
    deepest_ = std::max(deepest_, depth);
    // Offsets are measured from the present translation: N . (t - t_now) >= depth.
    add_plane({normal, depth, spinning && shell_.cutting[contact.point] != 0, 0.0}, arm);
  }
}

const ConstrainedToolState& ConstrainedTool::step(const ContactView& bone, const HandMotion& hand, double dt) noexcept {
  const double damping = config_.coupling_damping / dt;
  const double stiffness = config_.coupling_stiffness + damping;
  const Vec3 before = state_.world_from_tool.translation;
  // Massless tool under the coupling K (h - t) + B (h' - (t - t_before)/dt): it rests where that force vanishes, or where bone holds it.
  const Vec3 target = (config_.coupling_stiffness * hand.world_from_hand.translation + damping * (before + hand.velocity * dt)) / stiffness;
  Pose pose{hand.world_from_hand.rotation, before};
  const Quat& turn = pose.rotation;
  state_.flags = is_finite(target) && std::isfinite(turn.w + turn.x + turn.y + turn.z) ? 0u : static_cast<std::uint32_t>(kContactNotFinite);
  if (state_.flags != 0) {
    state_.on_hand = {};  // no force from motion that means nothing; the tool stays where it was
    return state_;
  }

  const double settled = 0.02 * margin_;  // a hundredth of a voxel
  const double allowed = 0.8 * margin_;   // swept: no move is longer than what the grown shell sees ahead, so nothing is passed unseen
  const auto hold = [&] {
    find_planes(bone, pose, hand.spinning);
    return solve_hold({target - pose.translation, stiffness, config_.cutting_stiffness}, {planes_.data(), plane_count_}, 0.01 * settled);
  };
  HoldSolution solution;
  Vec3 last_advance(0.0);
  double relaxation = 1.0;
  bool outside_before = false;  // a window smaller than the tool: then its edge says nothing
  std::uint32_t moves = 0;
  for (bool at_rest = false; !at_rest && moves < static_cast<std::uint32_t>(config_.max_moves); ++moves) {
    solution = hold();
    const bool outside = (contacts_.flags & kContactOutsideWindow) != 0;
    if (moves == 0) outside_before = outside;
    if (outside && !outside_before) {
      // What the window does not know is not free: step back and wait for it to follow, or a fast hand would outrun the bone.
      pose.translation -= last_advance;
      solution = hold();
      break;
    }
    const double length = glm::length(solution.translation);
    at_rest = length <= settled;
    // Planes found anew at each pose may disagree by fractions of a voxel; a reversal means that the truth lies between.
    if (glm::dot(solution.translation, last_advance) < 0.0) relaxation = std::max(0.125, 0.5 * relaxation);
    last_advance = solution.translation * std::min(relaxation, length > allowed ? allowed / length : 1.0);
    pose.translation += last_advance;
    if (relaxation <= 0.25 && length <= 10.0 * settled) at_rest = true;
  }

  state_.world_from_tool = pose;
  state_.engagement = solution.engagement;
  state_.deepest = deepest_;
  state_.planes = static_cast<std::uint32_t>(plane_count_);
  state_.moves = moves;
  // Bone's push on the tool passes through the coupling to the hand.
  state_.on_hand = {};
  for (std::size_t n = 0; n < plane_count_; ++n) {
    const Vec3 force = planes_[n].normal * planes_[n].force;
    state_.on_hand.force += force;
    state_.on_hand.torque += glm::cross(arms_[n], force);
  }
  return state_;
}

}  // namespace burrhole
