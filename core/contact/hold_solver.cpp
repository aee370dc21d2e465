#include "core/contact/hold_solver.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

HoldSolution solve_hold(const HoldProblem& problem, std::span<HoldPlane> planes, double tolerance) noexcept {
  const double give = 1.0 / problem.stiffness;              // of the tool against its coupling [m/N]
  const double cut_give = 1.0 / problem.cutting_stiffness;  // of the bone in front of a cutting point
  HoldSolution out;
  out.translation = problem.target;
  for (const HoldPlane& plane : planes) {
    out.translation += plane.normal * (plane.force * give);
    if (plane.cutting) out.engagement += plane.force * cut_give;
  }
  for (out.sweeps = 0; out.sweeps < kMaxHoldSweeps && !out.converged; ++out.sweeps) {
    double largest = 0.0;
    for (HoldPlane& plane : planes) {
      const double own_give = give + (plane.cutting ? cut_give : 0.0);
      const double gap = glm::dot(plane.normal, out.translation) - plane.offset + (plane.cutting ? out.engagement : 0.0);
      const double force = std::max(0.0, plane.force - gap / own_give);
      const double change = force - plane.force;
      if (change == 0.0) continue;
      plane.force = force;
      out.translation += plane.normal * (change * give);
      if (plane.cutting) out.engagement += change * cut_give;
      largest = std::max(largest, std::abs(change) * own_give);
    }
    out.converged = largest <= tolerance;
  }
  return out;
}

}  // namespace burrhole
