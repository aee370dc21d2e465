/// haptics/servo/local_tool.h: the held tool between two evaluations of contact: tied to the hand by the coupling's springs and dampers,
///   held back by the planes that the last evaluation listed, and moved at the servo's rate.
///   Frame  world.   Units SI.   Thread servo; fixed memory, no allocation.
///   Massless, as core/contact/constrained_tool.h: at each tick the pose is the one that hold_solver.h's problem has as its optimum, with
///   the dampers taken implicitly over the tick. Planes not touched at the sample are candidates like any other, so the next contact is
///   felt when the tool gets there. It steers the force only: what is drawn, cut and measured is the contact's own tool.
///   Cost  one HoldSolver::solve() over at most kMaxLocalPlanes candidates.
///   Source  own derivation.
#pragma once

#include "core/base/assert.h"
#include "core/contact/contact_state.h"
#include "core/contact/hold_solver.h"

namespace burrhole {

class LocalTool {
 public:
  /// Forgets where it was: the next state's tool is where it goes on.
  void clear() noexcept BH_REALTIME;
  /// A new state of kind `coupled`: its planes replace the old ones, and the tool goes on from where it is, no further than `max_distance`
  /// [m] from the state's own tool.
  void renew(const ContactState& state, double max_distance) noexcept BH_REALTIME;
  /// One servo tick of dt [s]; `state` as in the last renew(). @returns what the tool exerts on the hand: force [N], torque [N m] about its
  /// origin.
  [[nodiscard]] Wrench step(const ContactState& state, const Pose& world_from_hand, const Vec3& velocity, double dt) noexcept BH_REALTIME;

  [[nodiscard]] const Pose& world_from_tool() const noexcept { return world_from_tool_; }

 private:
  Pose world_from_tool_;
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  bool placed_ = false;
  HoldSolver solver_;
};

}  // namespace burrhole
