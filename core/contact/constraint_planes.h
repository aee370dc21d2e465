/// core/contact/constraint_planes.h: converts added constraints (contact_constraint.h) to planes for the hold solver and for penalty
///   models.
///   Frame  as named.   Units  SI.   Thread  contact; never allocates.
#pragma once

#include <array>
#include <span>

#include "core/contact/contact_constraint.h"
#include "core/contact/hold_solver.h"

namespace burrhole {

/// Candidates of a solve: the planes of the constraints at a pose of the tool, then the candidates of `others`.
class ConstraintPlanes final : public HoldCandidates {
 public:
  ConstraintPlanes(std::span<const ContactConstraint> constraints, const Pose& world_from_bone, const Pose& bone_from_tool,
                   HoldCandidates& others) noexcept;
  std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                         std::span<const HoldPlane> kept) noexcept override;

 private:
  std::array<HoldPlane, kMaxConstraints> planes_{};
  std::size_t count_ = 0;
  HoldCandidates* others_;
};

/// The plane of constraint n; normal, arm and gap in the axes of the frame that `world_from_frame` maps from.
[[nodiscard]] HoldPlane plane_of(const ContactConstraint& constraint, std::size_t n, const Pose& world_from_frame,
                                 const Pose& frame_from_tool) noexcept;

/// The wrench of the constraints on a tool at a pose: force [N], torque [N m] about its origin, world frame.
[[nodiscard]] Wrench constraint_wrench(std::span<const ContactConstraint> constraints, const Pose& world_from_tool) noexcept;

}  // namespace burrhole
