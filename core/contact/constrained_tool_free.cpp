// The constrained tool outside the window: free motion far from bone, and the hold where bone has not been read.
#include <cmath>

#include "core/base/rotation.h"
#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

constexpr double kLeastFree = 1.0;  // [voxel edges] a shorter free distance counts as none

}  // namespace

double ConstrainedTool::free_distance(const SurfaceView& bone) const noexcept {
  if (bone.coarse == nullptr) return 0.0;
  const double free = cover_.clearance(*bone.coarse, bone.records.bone_from_index.inverse() * Affine::from_pose(bone_from_tool_));
  return free >= kLeastFree * edge_ ? free : 0.0;
}

bool ConstrainedTool::move_freely(const Pose& bone_from_target, double free) noexcept {
  solver_.clear();
  hits_.clear();
  cutting_hits_ = 0;
  engaged_ = Vec3(0.0);
  const HoldMove move{.translation = bone_from_target.translation - bone_from_tool_.translation,
                      .turn = rotation_vector(bone_from_target.rotation * glm::conjugate(bone_from_tool_.rotation))};
  const double length = glm::length(move.translation) + glm::length(move.turn) * (points_.reach + glm::length(middle_));
  const double part = length > free ? free / length : 1.0;
  apply(move, part);
  since_look_ = {};
  return part == 1.0;
}

void ConstrainedTool::hold(const Pull& pull) noexcept {
  const Pose& tool = state_.world_from_tool;
  state_.on_hand.force = hold_force_.of(pull.stiffness * (tool.translation - pull.world_from_target.translation));
  state_.on_hand.torque = Vec3(0.0);
  if (state_.on_hand.force != Vec3(0.0) && std::isfinite(pull.turn_stiffness))
    state_.on_hand.torque = pull.turn_stiffness * rotation_vector(tool.rotation * glm::conjugate(pull.world_from_target.rotation));
  state_.tangential = {};
  state_.engagement = state_.cutting_force = 0.0;
}

}  // namespace burrhole
