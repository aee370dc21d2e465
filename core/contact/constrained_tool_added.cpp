// Additions of effects to a step of the constrained tool: constraints, and a law of tangential loads.
#include "core/contact/constrained_tool.h"
#include "core/contact/constraint_planes.h"
#include "core/contact/tool_sweep.h"

namespace burrhole {

HoldMove ConstrainedTool::solve_with(const SurfaceView& bone, const HoldProblem& problem, HoldCandidates& candidates) noexcept {
  ConstraintPlanes constrained(added_.constraints, bone.world_from_bone, bone_from_tool_, candidates);
  if (added_.tangential == nullptr) return solver_.solve(problem, constrained);
  HoldProblem fine = problem;
  fine.tolerance *= kFineTolerance;
  return tangential_.solve(*added_.tangential, slip_, fine, constrained, solver_);
}

void ConstrainedTool::begin_added(const ContactAdditions& added, double spin_rate, double dt, bool placed) noexcept {
  if (added.tangential != nullptr && (added_.tangential != added.tangential || !placed)) {
    added.tangential->clear();
    tangential_.clear();
  }
  added_ = added;
  slip_ = {.moved = {}, .spin = bone_from_tool_.rotate(Vec3(0.0, 0.0, spin_rate)), .dt = dt};
}

void ConstrainedTool::end_added() noexcept {
  constrained_ = !added_.constraints.empty();
  added_.constraints = {};  // the span is valid for the step only
  if (added_.tangential == nullptr) return;
  // An incomplete sweep has not reached the equilibrium of its loads: its residual is dropped.
  const bool arrived = (state_.flags & (kContactUnsettled | kContactOutsideWindow)) == 0;
  added_.tangential->end_step(arrived ? slip_.moved : tangential_.move());
}

}  // namespace burrhole
