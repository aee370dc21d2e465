/// core/contact/tangential_hold.h: solves normal loads (hold_solver.h) and tangential loads (tangential_law.h) of a massless tool together.
///   Frame  that of the hold problem; bone is at rest in it.   Units  SI.   Thread  contact or servo; never allocates.
///   Method  alternation, at most `most_rounds` times: the pose for the latest tangential loads, then the tangential loads for the latest
///           normal loads. The law sees the tool on its springs and on the loaded planes, so a load that pushes a wedged tool against a wall
///           meets the wall in the same round. On a flat face two rounds are exact. Where normals and tangents couple, the next loads are
///           mixed from those of all rounds, and where the change grows it is halved; the last change is the residual. One to three rounds
///           are usual, and all of them where planes come and go with the tangential load.
///   Flanks  A cutting plane is `held` while planes of lateral stiffness (flank_friction.h) are present. There the law adds the friction of the
///           rim speed, which is a force, and no resistance to displacement, so no lateral load is counted twice.
///   Source  the alternation is Panagiotopoulos' for contact with Coulomb friction and the mixing is Anderson's for fixed points, both as
///           commonly used; the rest is own derivation.
#pragma once

#include "core/base/assert.h"
#include "core/contact/hold_solver.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

struct TangentialStep {
  SmallMove moved;      ///< of the tool since the start of the step, at the pose for which the problem's gaps were measured
  Vec3 spin{0.0};       ///< [rad/s]
  double dt = 1e-3;     ///< [s] > 0
  int most_rounds = 8;  ///< at least 1
};

class TangentialHold {
 public:
  void clear() noexcept { loads_ = {}; }
  /// @returns the move, with normal and tangential loads. `problem` is that of the springs alone.
  HoldMove solve(TangentialLaw& law, const TangentialStep& step, const HoldProblem& problem, HoldCandidates& candidates,
                 HoldSolver& solver) noexcept BH_REALTIME;
  [[nodiscard]] const Wrench& on_tool() const noexcept { return loads_.on_tool; }  ///< [N], [N m] of the last solve()
  [[nodiscard]] const SmallMove& move() const noexcept { return loads_.move; }     ///< since the start of the step, by the law

 private:
  TangentialLoads loads_;
};

}  // namespace burrhole
