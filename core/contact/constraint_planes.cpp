#include "core/contact/constraint_planes.h"

#include <algorithm>

namespace burrhole {

HoldPlane plane_of(const ContactConstraint& constraint, std::size_t n, const Pose& world_from_frame, const Pose& frame_from_tool) noexcept {
  const Pose frame_from_world = world_from_frame.inverse();
  HoldPlane plane;
  plane.normal = frame_from_world.rotate(constraint.normal);
  plane.arm = frame_from_tool.rotate(constraint.point);
  plane.gap = glm::dot(plane.normal, frame_from_tool.translation + plane.arm - frame_from_world * constraint.plane_point);
  plane.yield = 1.0 / constraint.stiffness;
  plane.point = kConstraintPoint + static_cast<std::uint32_t>(n);
  return plane;
}

ConstraintPlanes::ConstraintPlanes(std::span<const ContactConstraint> constraints, const Pose& world_from_bone, const Pose& bone_from_tool,
                                   HoldCandidates& others) noexcept
    : count_(std::min(constraints.size(), kMaxConstraints)), others_(&others) {
  for (std::size_t n = 0; n < count_; ++n) planes_[n] = plane_of(constraints[n], n, world_from_bone, bone_from_tool);
}

std::optional<HoldPlane> ConstraintPlanes::most_violated(const HoldProblem& problem, const HoldMove& move,
                                                         std::span<const HoldPlane> kept) noexcept {
  for (const HoldPlane& plane : std::span(planes_.data(), count_)) {
    if (std::ranges::find(kept, plane.point, &HoldPlane::point) != kept.end()) continue;
    if (plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, plane.arm)) < -problem.tolerance) return plane;
  }
  return others_->most_violated(problem, move, kept);
}

Wrench constraint_wrench(std::span<const ContactConstraint> constraints, const Pose& world_from_tool) noexcept {
  Wrench out;
  for (std::size_t n = 0; n < std::min(constraints.size(), kMaxConstraints); ++n) {
    const HoldPlane plane = plane_of(constraints[n], n, Pose{}, world_from_tool);
    const Vec3 force = plane.normal * (std::max(0.0, -plane.gap) / plane.yield);
    out.force += force;
    out.torque += glm::cross(plane.arm, force);
  }
  return out;
}

}  // namespace burrhole
