#include "core/contact/tangential_hold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/contact/contact_constraint.h"

namespace burrhole {
namespace {

// [-] of the normal loads: a smaller change ends the rounds. The move that it leaves is kept as the law's residual of this step.
constexpr double kSameLoad = 1e-6;
constexpr double kLever = 0.01;  // [m] of pressed points: weighs torques and turns against forces and moves

struct Springs {
  double stiffness, turn_stiffness;
  [[nodiscard]] SmallMove under(const Wrench& load) const noexcept { return {load.force / stiffness, load.torque / turn_stiffness}; }
};

/// The loaded planes of bone as pressed points for the law. @returns their number.
std::size_t pressed_of(const HoldSolver& solver, std::array<PressedPoint, kMaxHoldPlanes>& out) noexcept {
  const bool on_flanks = std::ranges::any_of(solver.planes(), &HoldPlane::both_ways);
  std::size_t count = 0;
  for (const HoldPlane& plane : solver.planes())
    if (!plane.both_ways && plane.force > 0.0 && plane.point < kConstraintPoint)
      out[count++] = {
          .point = plane.point, .arm = plane.arm, .normal = plane.normal, .load = plane.force, .held = on_flanks && plane.cutting};
  return count;
}

/// @returns the move that a load makes against springs and planes.
SmallMove moved_by(const Wrench& load, Matrix6 supports, const Springs& springs) noexcept {
  for (std::size_t n = 0; n < 6; ++n) supports[n][n] += n < 3 ? springs.stiffness : springs.turn_stiffness;
  const Vector6 d = solve_spd(supports, {load.force.x, load.force.y, load.force.z, load.torque.x, load.torque.y, load.torque.z});
  return {{d[0], d[1], d[2]}, {d[3], d[4], d[5]}};
}

Vector6 numbers_of(const Wrench& load) noexcept {
  const Vec3 torque = load.torque / kLever;
  return {load.force.x, load.force.y, load.force.z, torque.x, torque.y, torque.z};
}
Wrench wrench_of(const Vector6& x) noexcept { return {{x[0], x[1], x[2]}, kLever * Vec3(x[3], x[4], x[5])}; }

/// Accelerates a fixed point iteration x <- g(x) of six unknowns, as Anderson's mixing of all rounds so far: a map that is linear converges in
/// seven rounds, whatever its contraction. Differences of residuals are kept orthonormal, each with its difference of g.
class Mixing {
 public:
  /// @returns the next x. A residual that grows restarts the mixing with a plain step.
  [[nodiscard]] Vector6 next(const Vector6& x, const Vector6& g) noexcept {
    Vector6 residual{};
    for (std::size_t k = 0; k < 6; ++k) residual[k] = g[k] - x[k];
    const double size = dot(residual, residual);
    const bool grows = !(size < size_);
    if (count_ == kMost || grows)
      count_ = 0;
    else if (rounds_ > 0)
      keep(residual, g);
    ++rounds_;
    residual_ = residual;
    size_ = size;
    g_ = g;
    if (grows) {
      Vector6 half = x;
      for (std::size_t k = 0; k < 6; ++k) half[k] += 0.5 * residual[k];
      return half;
    }
    Vector6 out = g;
    for (std::size_t n = 0; n < count_; ++n) {
      const double part = dot(kept_[n].residual, residual);
      for (std::size_t k = 0; k < 6; ++k) out[k] -= part * kept_[n].g[k];
      for (std::size_t k = 0; k < 6; ++k) residual[k] -= part * kept_[n].residual[k];
    }
    return out;
  }

 private:
  static constexpr std::size_t kMost = 6;
  static constexpr double kDependent = 1e-6;  // [-] of a difference that is left beside the kept ones: less is rounding
  struct Difference {
    Vector6 residual, g;
  };
  static double dot(const Vector6& a, const Vector6& b) noexcept {
    double out = 0.0;
    for (std::size_t k = 0; k < 6; ++k) out += a[k] * b[k];
    return out;
  }
  void keep(const Vector6& residual, const Vector6& g) noexcept {
    Difference fresh;
    for (std::size_t k = 0; k < 6; ++k) fresh.residual[k] = residual[k] - residual_[k];
    for (std::size_t k = 0; k < 6; ++k) fresh.g[k] = g[k] - g_[k];
    const double whole = std::sqrt(dot(fresh.residual, fresh.residual));
    for (std::size_t n = 0; n < count_; ++n) {
      const double part = dot(kept_[n].residual, fresh.residual);
      for (std::size_t k = 0; k < 6; ++k) fresh.residual[k] -= part * kept_[n].residual[k];
      for (std::size_t k = 0; k < 6; ++k) fresh.g[k] -= part * kept_[n].g[k];
    }
    const double left = std::sqrt(dot(fresh.residual, fresh.residual));
    if (!(left > kDependent * whole)) return;
    for (double& value : fresh.residual) value /= left;
    for (double& value : fresh.g) value /= left;
    kept_[count_++] = fresh;
  }

  std::array<Difference, kMost> kept_;
  std::size_t count_ = 0;
  int rounds_ = 0;
  Vector6 residual_{}, g_{};  // of the last round
  double size_ = std::numeric_limits<double>::infinity();
};

}  // namespace

HoldMove TangentialHold::solve(TangentialLaw& law, const TangentialStep& step, const HoldProblem& problem, HoldCandidates& candidates,
                               HoldSolver& solver) noexcept {
  const Springs springs{problem.stiffness, problem.turn_stiffness};
  std::array<PressedPoint, kMaxHoldPlanes> points;
  HoldMove move;
  Mixing mixing;
  for (int round = 0; round < step.most_rounds; ++round) {
    const SmallMove shift = springs.under(loads_.on_tool);
    HoldProblem shifted = problem;
    shifted.target += shift.translation;
    shifted.turn += shift.turn;
    move = solver.solve(shifted, candidates);
    const std::size_t count = pressed_of(solver, points);
    const bool braced = !std::isinf(problem.turn_stiffness);
    const Matrix6 planes = braced ? stiffness_of(problem, solver.planes()) : Matrix6{};
    const SmallMove pushed = braced ? moved_by(loads_.on_tool, planes, springs) : shift;
    const TangentialLoads found =
        law.loads({.points = {points.data(), count},
                   .free = {step.moved.translation + move.translation - pushed.translation, step.moved.turn + move.turn - pushed.turn},
                   .stiffness = problem.stiffness,
                   .turn_stiffness = problem.turn_stiffness,
                   .planes = braced ? &planes : nullptr,
                   .spin = step.spin,
                   .dt = step.dt});
    double pressed = 0.0;
    for (const PressedPoint& point : std::span(points.data(), count)) pressed += point.load;
    const double enough = kSameLoad * pressed;
    const Vec3 force = found.on_tool.force - loads_.on_tool.force, torque = found.on_tool.torque - loads_.on_tool.torque;
    const SmallMove change = springs.under({force, torque});
    // When the bound on rounds is reached the loads stay those of the move, so that they balance.
    const bool same = glm::length(force) <= enough && glm::length(change.turn) * kLever * springs.stiffness <= enough;
    loads_.move = found.move;
    if (same) {
      loads_.on_tool = found.on_tool;
      break;
    }
    if (round + 1 < step.most_rounds) loads_.on_tool = wrench_of(mixing.next(numbers_of(loads_.on_tool), numbers_of(found.on_tool)));
  }
  return move;
}

}  // namespace burrhole
