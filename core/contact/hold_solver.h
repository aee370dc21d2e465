/// core/contact/hold_solver.h: computes the constrained pose nearest to the target of the hand, in six degrees of freedom.
///   Frame  any, the same for all inputs; bone is at rest in it.   Units  SI.
///   Own derivation. Unknowns: the translation t of the tool, its rotation w (small), the engagement e of a spinning tool, and the yield
///   y_i of bone at each plane. Minimise
///       K/2 |t - target|^2 + K_r/2 |w - turn|^2 + K_cut/2 |e|^2 + sum y_i^2 / (2 yield_i)
///   subject to, for each plane i at lever arm a_i,
///       N_i . (t + w x a_i + [cutting] (e - engaged)) + y_i >= -gap_i.
///   Cutting planes constrain the proxy pose: the tool moved by e, its pose without engagement. Contact is therefore always from the outer
///   side of bone, at any engaged depth. The multipliers f_i >= 0 are the contact forces. At the optimum K (t - target) = sum N_i f_i, so
///   the coupling transmits the contact forces, and K_cut e = sum over cutting planes of N_i f_i, so engaged depth = F / K_cut. Forces of
///   opposed walls act through their yields and cancel in e, so walls do not change the engagement of a blade in a slot.
///   A plane with `both_ways` is a spring of stiffness 1 / yield along its normal: N . (t + w x a) + y = -gap with f of either sign.
///   Method: each round adds the most violated plane of a candidate source, and finds the optimum among the kept planes by Newton's method
///   with a line search, in the 6 or 9 unknowns of the move alone. That energy is convex and piecewise quadratic, so the result is exact to
///   rounding after finitely many steps. Where no more planes fit, the new one takes the room of the plane without which the energy falls
///   least. A round that does not raise the energy ends the solution, so no set of planes comes back. The cost of a round is linear in the
///   number of planes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/geometry.h"
#include "core/base/spd.h"

namespace burrhole {

struct HoldPlane {
  Vec3 normal{0.0, 0.0, 1.0};  ///< [-] outward unit normal of bone
  Vec3 arm{0.0};               ///< [m] from the tool origin to the contact point
  double gap = 0.0;            ///< [m] current distance, negative inside
  double yield = 0.0;          ///< [m/N] > 0: compliance of bone under this plane
  bool cutting = false;
  std::uint32_t point = 0;  ///< shell point of the plane; each point has at most one plane
  double force = 0.0;       ///< [N] out: >= 0, of either sign with both_ways
  Vec3 place{0.0};          ///< [m] tool frame: the contact point as its source keeps it; the solver does not read it
  bool both_ways = false;   ///< also exerts attractive forces and is never dropped; not cutting
};

struct HoldProblem {
  Vec3 target{0.0};                ///< [m] requested translation
  Vec3 turn{0.0};                  ///< [rad] requested rotation vector
  Vec3 engaged{0.0};               ///< [m] engagement at which the gaps of cutting planes were measured
  double stiffness = 1.0;          ///< [N/m] K > 0
  double turn_stiffness = 1.0;     ///< [N m/rad] K_r > 0; infinite: the rotation is the requested one
  double cutting_stiffness = 1.0;  ///< [N/m] K_cut > 0
  double tolerance = 1e-7;         ///< [m] smaller violations are accepted
};

/// A solution, or an intermediate state.
struct HoldMove {
  Vec3 translation{0.0};  ///< [m] t
  Vec3 turn{0.0};         ///< [rad] w
  Vec3 engagement{0.0};   ///< [m] e
};

/// Source of planes. Returns the most violated candidate after a move whose point is not among the kept planes; empty when no violation
/// exceeds the tolerance of the problem.
class HoldCandidates {
 public:
  virtual ~HoldCandidates() = default;
  [[nodiscard]] virtual std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                                               std::span<const HoldPlane> kept) noexcept = 0;
};

inline constexpr std::size_t kMaxHoldPlanes = 64;  ///< loaded at once: more than the unknowns only where bone yields
inline constexpr int kMaxHoldRounds = 96;          ///< planes added per solve

class HoldSolver {
 public:
  /// Starts from the kept planes (warm start: refresh their gaps, normals and arms first). Adds and drops planes until none is violated or
  /// the bound on rounds is reached. Never allocates. @returns the move.
  HoldMove solve(const HoldProblem& problem, HoldCandidates& candidates) noexcept;

  /// Planes that carry load after solve(). Refresh or clear them before the next solve().
  [[nodiscard]] std::span<HoldPlane> planes() noexcept { return {planes_.data(), count_}; }
  [[nodiscard]] std::span<const HoldPlane> planes() const noexcept { return {planes_.data(), count_}; }
  void clear() noexcept { count_ = 0; }
  /// Adds a plane before solve(). When full, it replaces the plane with the least force.
  void add(const HoldPlane& plane) noexcept;
  /// Drops planes for which keep(plane) is false; keep may change the plane.
  template <class Keep>
  void refresh(Keep&& keep) noexcept {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < count_; ++n)
      if (keep(planes_[n])) planes_[kept++] = planes_[n];
    count_ = kept;
  }
  [[nodiscard]] int rounds() const noexcept { return rounds_; }
  [[nodiscard]] bool converged() const noexcept { return converged_; }

 private:
  [[nodiscard]] HoldMove move_of(const HoldProblem& problem) const noexcept;
  /// Finds the optimal forces of the kept planes; drops planes without force.
  void settle(const HoldProblem& problem) noexcept;
  /// @returns [m] the largest yield of bone under a plane.
  [[nodiscard]] double deepest() const noexcept;

  std::array<HoldPlane, kMaxHoldPlanes> planes_{};
  std::size_t count_ = 0;
  int rounds_ = 0;
  bool converged_ = false;
};

/// @returns the stiffness of planes against a move of the tool (translation, then turn): the second derivative of their energy at the best
/// engagement. All of them are taken as loaded. The lower triangle is set. @param problem with a finite turn stiffness.
[[nodiscard]] Matrix6 stiffness_of(const HoldProblem& problem, std::span<const HoldPlane> planes) noexcept;

}  // namespace burrhole
