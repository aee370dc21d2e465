/// tests/core/contact/hold_support.h: problems for the hold solver, and the plain truth about them: every active set tried, each solved in
///   all the unknowns of the definition (move, turn, engagement, yields, forces) at once, in extended precision.
///   Units  SI.   Shares no formula with the solver: its matrix is what the definition says of one unknown at a time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/contact/hold_solver.h"

namespace burrhole::hold_test {

/// [m] of test problems: well above roundings (1e-18), far below all that is checked.
inline constexpr double kTightTolerance = 1e-15;
inline constexpr double kLeastYield = 1e-7;  ///< [m/N]

// With violations up to d left standing, H the weights, and D a difference to the optimum, optimality of both gives
//   Du.H.Du + sum yield Df^2 <= d sum |Df|,   hence   |Df| <= sqrt(n) d / yield   and   Du.H.Du <= n d^2 / yield.
// With n = 40, d and yield as above and K >= 2000 N/m, K_r >= 5 N m/rad: 6e-8 N, 4.5e-13 m, 9e-12 rad. Roundings are below these.
inline constexpr double kAllowedForce = 1e-7, kAllowedLength = 1e-12, kAllowedTurn = 2e-11;

struct HoldTruth {
  HoldMove move;
  std::vector<double> forces;  ///< [N] of all planes
};

/// What a broken solver would solve.
enum class Sabotage { none, no_arms, scalar_engagement, engaged_forgotten, no_yield, one_way };

/// Gap of a plane after a move, without its yield: the definition.
double gap_of(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move);

/// The optimum, or nothing when no active set meets the conditions (sabotage may do that). At most about 8 planes.
std::optional<HoldTruth> enumerate(const HoldProblem& problem, const std::vector<HoldPlane>& planes, Sabotage sabotage = Sabotage::none);

/// The hand pushes down, more or less, by up to 1 mm, and turns.
HoldProblem random_problem(std::uint64_t n);
/// Planes that face upwards, more or less, near the tool origin; arms up to 20 mm; half of them cut. Points are 0, 1, 2, ... Every third
/// set of few planes faces all ways, most of them broken at the start: there many carry load.
std::vector<HoldPlane> random_planes(std::uint64_t n, std::size_t count);

/// Candidates from a list, looked through plainly.
class ListedCandidates final : public HoldCandidates {
 public:
  explicit ListedCandidates(const std::vector<HoldPlane>& planes) : planes_(&planes) {}
  std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                         std::span<const HoldPlane> kept) noexcept override;

 private:
  const std::vector<HoldPlane>* planes_;
};

}  // namespace burrhole::hold_test
