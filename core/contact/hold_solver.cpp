#include "core/contact/hold_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

// Least fraction of a plane's compliance that is independent of earlier planes: below it the rest is rounding and the force is
// undetermined.
constexpr double kOwnPart = 1e-13;

/// Gap of a plane after a move, with its yield.
double gap_after(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move) noexcept {
  const Vec3 engaging = plane.cutting ? move.engagement - problem.engaged : Vec3(0.0);
  return plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, plane.arm) + engaging) + plane.yield * plane.force;
}

}  // namespace

HoldMove HoldSolver::move_of(const HoldProblem& problem) const noexcept {
  HoldMove out{problem.target, problem.turn, Vec3(0.0)};
  for (const HoldPlane& plane : planes()) {
    const Vec3 push = plane.normal * plane.force;
    out.translation += push / problem.stiffness;
    out.turn += glm::cross(plane.arm, push) / problem.turn_stiffness;
    if (plane.cutting) out.engagement += push / problem.cutting_stiffness;
  }
  return out;
}

bool HoldSolver::factor_row(const HoldProblem& problem, std::size_t r) noexcept {
  const HoldPlane& plane = planes_[r];
  auto& rows = factor_.rows;
  auto& right = factor_.right;
  auto& turning = factor_.turning;
  turning[r] = glm::cross(plane.arm, plane.normal);
  for (std::size_t c = 0; c <= r; ++c) {
    // Change of one plane's gap per unit force on the other [m/N].
    const double along = glm::dot(plane.normal, planes_[c].normal);
    double whole = along / problem.stiffness + glm::dot(turning[r], turning[c]) / problem.turn_stiffness +
                   (plane.cutting && planes_[c].cutting ? along / problem.cutting_stiffness : 0.0);
    if (r == c) whole += plane.yield;
    double sum = whole;
    for (std::size_t k = 0; k < c; ++k) sum -= rows[r][k] * rows[c][k];
    if (r != c) {
      rows[r][c] = sum / rows[c][c];
    } else {
      if (!(sum > kOwnPart * whole)) return false;
      rows[r][r] = std::sqrt(sum);
    }
  }
  // The right side is the negative of the gap without forces.
  HoldPlane unloaded = plane;
  unloaded.force = 0.0;
  right[r] = -gap_after(problem, unloaded, {problem.target, problem.turn, Vec3(0.0)});
  for (std::size_t k = 0; k < r; ++k) right[r] -= rows[r][k] * right[k];
  right[r] /= rows[r][r];
  return true;
}

bool HoldSolver::solve_kept(const HoldProblem& problem, std::array<double, kMaxHoldPlanes>& forces) noexcept {
  for (; factor_.known < count_; ++factor_.known)
    if (!factor_row(problem, factor_.known)) return false;
  forces = factor_.right;
  for (std::size_t r = count_; r-- > 0;) {
    for (std::size_t k = r + 1; k < count_; ++k) forces[r] -= factor_.rows[k][r] * forces[k];
    forces[r] /= factor_.rows[r][r];
  }
  return true;
}

void HoldSolver::drop(std::size_t n) noexcept {
  std::copy(planes_.begin() + static_cast<std::ptrdiff_t>(n) + 1, planes_.begin() + static_cast<std::ptrdiff_t>(count_),
            planes_.begin() + static_cast<std::ptrdiff_t>(n));
  --count_;
  factor_.known = std::min(factor_.known, n);
}

void HoldSolver::drop_least() noexcept {
  const auto carries = [](const HoldPlane& plane) { return plane.both_ways ? std::numeric_limits<double>::infinity() : plane.force; };
  const auto kept = planes();
  const auto least = std::ranges::min_element(kept, {}, carries);
  drop(static_cast<std::size_t>(least - kept.begin()));
}

void HoldSolver::add(const HoldPlane& plane) noexcept {
  if (count_ == kMaxHoldPlanes) drop_least();
  planes_[count_] = plane;
  planes_[count_++].force = 0.0;
}

void HoldSolver::settle(const HoldProblem& problem) noexcept {
  std::array<double, kMaxHoldPlanes> wanted{};
  while (count_ > 0) {
    if (!solve_kept(problem, wanted)) {
      drop(count_ - 1);  // numerically dependent planes: one is enough
      continue;
    }
    // Steps towards the optimal forces until one of them would become attractive.
    double part = 1.0;
    std::size_t first = count_;
    for (std::size_t n = 0; n < count_; ++n) {
      if (wanted[n] > 0.0 || planes_[n].both_ways) continue;
      const double reach = planes_[n].force / (planes_[n].force - wanted[n]);
      if (first == count_ || reach < part) {
        part = planes_[n].force > 0.0 ? reach : 0.0;
        first = n;
      }
    }
    if (first == count_) {
      for (std::size_t n = 0; n < count_; ++n) planes_[n].force = wanted[n];
      return;
    }
    // The limiting plane ends at 0; another at the same place may end below it by rounding.
    for (std::size_t n = 0; n < count_; ++n) {
      const double force = planes_[n].force + part * (wanted[n] - planes_[n].force);
      planes_[n].force = planes_[n].both_ways ? force : std::max(0.0, force);
    }
    drop(first);
  }
}

HoldMove HoldSolver::solve(const HoldProblem& problem, HoldCandidates& candidates) noexcept {
  factor_.known = 0;
  settle(problem);
  converged_ = false;
  for (rounds_ = 0; rounds_ < kMaxHoldRounds; ++rounds_) {
    const HoldMove move = move_of(problem);
    const auto found = candidates.most_violated(problem, move, planes());
    if (!found) {
      converged_ = true;
      return move;
    }
    const std::size_t before = count_;
    add(*found);
    settle(problem);
    // Dropped at once while all others stayed: the same plane would be found again in each round.
    if (count_ == before && std::ranges::find(planes(), found->point, &HoldPlane::point) == planes().end()) break;
  }
  return move_of(problem);
}

}  // namespace burrhole
