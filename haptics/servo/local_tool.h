/// haptics/servo/local_tool.h: the constrained tool at the servo's rate between two evaluations of contact. The coupling's springs and
///   dampers tie it to the hand; the planes of the last evaluation constrain it.
///   Frame  world.   Units SI.   Thread servo; fixed memory, no allocation.
///   The tool is massless, as in core/contact/constrained_tool.h. At each tick its pose is the optimum of the problem of hold_solver.h,
///   with the dampers integrated implicitly over the tick. Planes without load at the sample are candidates too, so a new contact acts as
///   soon as the tool reaches it. This tool computes the force only; display, cutting and measurement use the tool of contact.
///   Cost  one HoldSolver::solve() over at most kMaxLocalPlanes candidates.
///   Source  own derivation.
#pragma once

#include "core/base/assert.h"
#include "core/contact/contact_state.h"
#include "core/contact/hold_solver.h"
#include "core/contact/tangential_hold.h"

namespace burrhole {

class LocalTool {
 public:
  /// Resets the pose; the next renew() starts at the pose of its state.
  void clear() noexcept BH_REALTIME;
  /// Takes a new state of kind `coupled`. Its planes replace the old ones. The tool keeps its pose, limited to `max_distance` [m] from the
  /// tool of the state.
  void renew(const ContactState& state, double max_distance) noexcept BH_REALTIME;
  /// One servo tick of dt [s]; `state` as in the last renew(). @returns the wrench of the tool on the hand: force [N], torque [N m] about
  /// the tool's origin.
  /// @param law tangential loads between the tool and the planes; null: none. Not owned; used by this tool alone.
  [[nodiscard]] Wrench step(const ContactState& state, const Pose& world_from_hand, const Vec3& velocity, double dt,
                            TangentialLaw* law = nullptr) noexcept BH_REALTIME;

  /// Moves the tool to another place, without a displacement over bone.
  void place(const Pose& world_from_tool) noexcept { world_from_tool_ = world_from_tool; }
  [[nodiscard]] const Pose& world_from_tool() const noexcept { return world_from_tool_; }

 private:
  Pose world_from_tool_;
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  bool placed_ = false;
  HoldSolver solver_;
  TangentialHold tangential_;
};

}  // namespace burrhole
