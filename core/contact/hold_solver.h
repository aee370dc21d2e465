/// core/contact/hold_solver.h: the pose nearest to where the hand wants the tool that the contact planes allow.
///   Own derivation: minimise 1/2 K |t - target|^2 + 1/2 K_cut s^2 over translation t and shared engagement s >= 0, subject to
///   N_i . t >= offset_i - s for planes that cut and N_i . t >= offset_i for planes that do not. Its multipliers are the contact forces;
///   at the optimum the forces on cutting planes add up to K_cut s: engaged depth = F / K_cut.
#pragma once

#include <span>

#include "core/base/geometry.h"

namespace burrhole {

struct HoldPlane {
  Vec3 normal{0.0, 0.0, 1.0};  ///< outward unit normal of bone
  double offset = 0.0;         ///< [m] along the normal; t is measured from the same origin
  bool cutting = false;
  double force = 0.0;  ///< [N] out: multiplier, >= 0
};

struct HoldProblem {
  Vec3 target{0.0};                ///< [m]
  double stiffness = 1.0;          ///< [N/m] K > 0
  double cutting_stiffness = 1.0;  ///< [N/m] K_cut > 0
};

struct HoldSolution {
  Vec3 translation{0.0};    ///< [m]
  double engagement = 0.0;  ///< [m] s
  int sweeps = 0;
  bool converged = false;
};

inline constexpr int kMaxHoldSweeps = 200;

/// Projected Gauss-Seidel on the multipliers; at most kMaxHoldSweeps passes over the planes; stops when no constraint moves by more than
/// `tolerance` [m]. Planes' `force` on entry is the warm start.
[[nodiscard]] HoldSolution solve_hold(const HoldProblem& problem, std::span<HoldPlane> planes, double tolerance) noexcept;

}  // namespace burrhole
