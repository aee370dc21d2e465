/// core/contact/hold_solver.h: the pose nearest to where the hand wants the tool that bone allows, with all six degrees of freedom.
///   Own derivation. Unknowns: the move t of the tool, its turn w (small), the engagement e of a spinning tool, and a yield y_i of bone at
///   each plane. Minimise
///       K/2 |t - target|^2 + K_r/2 |w - turn|^2 + K_cut/2 |e|^2 + sum y_i^2 / (2 yield_i)
///   subject to, for each plane i at lever arm a_i,
///       N_i . (t + w x a_i + [cutting] (e - engaged)) + y_i >= -gap_i.
///   A cutting plane is held against the tool moved back by e, the pose it would have without engagement, so bone is met from its own side
///   however deep the tool is engaged. The multipliers f_i >= 0 are the contact forces. At the optimum K (t - target) = sum N_i f_i: what
///   bone does is what the coupling feels; and K_cut e = sum over cutting planes of N_i f_i: engaged depth = F / K_cut. Opposed walls push
///   against each other through their yields and add nothing to e, so a blade in a slot is not let down by its sides.
///   A plane that holds `both_ways` is a spring of stiffness 1 / yield along its normal: N . (t + w x a) + y = -gap with f of either sign.
///   Method: active set on the multipliers (Lawson & Hanson's NNLS on the dual), where the plane to add is the most violated of all
///   candidates, asked from a source: exact for any number of contacts, with a matrix as small as the number of planes that carry load.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/geometry.h"

namespace burrhole {

struct HoldPlane {
  Vec3 normal{0.0, 0.0, 1.0};  ///< outward unit normal of bone
  Vec3 arm{0.0};               ///< [m] from the tool origin to the point that touches
  double gap = 0.0;            ///< [m] distance now, negative inside
  double yield = 0.0;          ///< [m/N] > 0: bone's own give under this plane
  bool cutting = false;
  std::uint32_t point = 0;  ///< which shell point: a plane is added once only
  double force = 0.0;       ///< [N] out: >= 0, but for both ways
  bool both_ways = false;   ///< pulls as well as pushes, and is never dropped; not cutting
};

struct HoldProblem {
  Vec3 target{0.0};                ///< [m] move that the hand asks for
  Vec3 turn{0.0};                  ///< [rad] rotation vector that the hand asks for
  Vec3 engaged{0.0};               ///< [m] engagement at which the gaps of cutting planes were measured
  double stiffness = 1.0;          ///< [N/m] K > 0
  double turn_stiffness = 1.0;     ///< [N m/rad] K_r > 0; infinite: the turn is what the hand asks for
  double cutting_stiffness = 1.0;  ///< [N/m] K_cut > 0
  double tolerance = 1e-7;         ///< [m] violations below this are none
};

/// A solution, or the state on the way to one.
struct HoldMove {
  Vec3 translation{0.0};  ///< [m] t
  Vec3 turn{0.0};         ///< [rad] w
  Vec3 engagement{0.0};   ///< [m] e
};

/// Where planes come from: the most violated candidate after a move that is not among those kept (by its point); nothing when none is
/// violated by more than the problem's tolerance.
class HoldCandidates {
 public:
  virtual ~HoldCandidates() = default;
  [[nodiscard]] virtual std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                                               std::span<const HoldPlane> kept) noexcept = 0;
};

inline constexpr std::size_t kMaxHoldPlanes = 24;  ///< carrying load at once: more than the unknowns only where bone yields
inline constexpr int kMaxHoldRounds = 96;          ///< planes added in one solve; each round solves at most kMaxHoldPlanes small systems

class HoldSolver {
 public:
  /// Starts from the planes that are kept (warm start: refresh their gaps, normals and arms first), adds and drops until nothing is
  /// violated or the bound on rounds is met. Never allocates. @returns the move.
  HoldMove solve(const HoldProblem& problem, HoldCandidates& candidates) noexcept;

  /// Planes that carry load after solve(); to be refreshed or cleared before the next.
  [[nodiscard]] std::span<HoldPlane> planes() noexcept { return {planes_.data(), count_}; }
  [[nodiscard]] std::span<const HoldPlane> planes() const noexcept { return {planes_.data(), count_}; }
  void clear() noexcept { count_ = 0; }
  /// Adds a plane before solve(), in place of the one that carries least when there is no room.
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
  /// Equality solve on all kept planes; false when the matrix is not positive definite to rounding.
  [[nodiscard]] bool solve_kept(const HoldProblem& problem, std::array<double, kMaxHoldPlanes>& forces) noexcept;
  /// Row r of the factor, from those before it; false likewise.
  [[nodiscard]] bool factor_row(const HoldProblem& problem, std::size_t r) noexcept;
  /// Brings the forces to the optimum over the kept planes, dropping those that would pull.
  void settle(const HoldProblem& problem) noexcept;
  void drop(std::size_t n) noexcept;
  void drop_least() noexcept;

  /// Cholesky's factor of the compliance among the kept planes. Its rows hold for one problem, until a plane before them is dropped.
  struct Factor {
    std::array<std::array<double, kMaxHoldPlanes>, kMaxHoldPlanes> rows;
    std::array<double, kMaxHoldPlanes> right;  // solved forward
    std::array<Vec3, kMaxHoldPlanes> turning;  // [m] lever arm times normal, of each plane
    std::size_t known = 0;                     // rows
  };

  std::array<HoldPlane, kMaxHoldPlanes> planes_{};
  std::size_t count_ = 0;
  Factor factor_{};
  int rounds_ = 0;
  bool converged_ = false;
};

}  // namespace burrhole
