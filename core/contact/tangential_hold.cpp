#include "core/contact/tangential_hold.h"

#include <algorithm>
#include <array>

#include "core/contact/contact_constraint.h"

namespace burrhole {
namespace {

constexpr double kSameForce = 1e-10;  // [N]: moves a tool on 5 kN/m by 2e-14 m

struct Springs {
  double stiffness, turn_stiffness;
  [[nodiscard]] SmallMove under(const Wrench& load) const noexcept { return {load.force / stiffness, load.torque / turn_stiffness}; }
};

/// The loaded planes of bone as pressed points for the law. @returns their number.
std::size_t pressed_of(const HoldSolver& solver, std::array<PressedPoint, kMaxHoldPlanes>& out) noexcept {
  const bool gripped = std::ranges::any_of(solver.planes(), &HoldPlane::both_ways);
  std::size_t count = 0;
  for (const HoldPlane& plane : solver.planes())
    if (!plane.both_ways && plane.force > 0.0 && plane.point < kConstraintPoint)
      out[count++] = {
          .point = plane.point, .arm = plane.arm, .normal = plane.normal, .load = plane.force, .held = gripped && plane.cutting};
  return count;
}

}  // namespace

HoldMove TangentialHold::solve(TangentialLaw& law, const TangentialStep& step, const HoldProblem& problem, HoldCandidates& candidates,
                               HoldSolver& solver) noexcept {
  const Springs springs{problem.stiffness, problem.turn_stiffness};
  std::array<PressedPoint, kMaxHoldPlanes> points;
  HoldMove move;
  for (int round = 0; round < kMaxRounds; ++round) {
    const SmallMove shift = springs.under(loads_.on_tool);
    HoldProblem shifted = problem;
    shifted.target += shift.translation;
    shifted.turn += shift.turn;
    move = solver.solve(shifted, candidates);
    const std::size_t count = pressed_of(solver, points);
    const TangentialLoads found =
        law.loads({.points = {points.data(), count},
                   .free = {step.moved.translation + move.translation - shift.translation, step.moved.turn + move.turn - shift.turn},
                   .stiffness = problem.stiffness,
                   .turn_stiffness = problem.turn_stiffness,
                   .spin = step.spin,
                   .dt = step.dt});
    const Vec3 force = found.on_tool.force - loads_.on_tool.force, torque = found.on_tool.torque - loads_.on_tool.torque;
    const SmallMove change = springs.under({force, torque});
    // When the bound on rounds is reached the loads stay those of the move, so that they balance.
    const bool same = glm::length(force) <= kSameForce && glm::length(change.turn) * springs.stiffness <= kSameForce;
    if (same || round + 1 < kMaxRounds) loads_.on_tool = found.on_tool;
    loads_.move = found.move;
    if (same) break;
  }
  return move;
}

}  // namespace burrhole
