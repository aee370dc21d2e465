#include "hold_support.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace burrhole::hold_test {
namespace {

using Real = long double;
using Rows = std::vector<std::vector<Real>>;

/// Elimination with full pivoting; nothing when singular. `a` has the right side as its last column.
std::optional<std::vector<Real>> eliminate(Rows a) {
  const std::size_t n = a.size();
  std::vector<std::size_t> column(n);
  for (std::size_t c = 0; c < n; ++c) column[c] = c;
  for (std::size_t step = 0; step < n; ++step) {
    std::size_t row = step, col = step;
    for (std::size_t r = step; r < n; ++r)
      for (std::size_t c = step; c < n; ++c)
        if (std::abs(a[r][c]) > std::abs(a[row][col])) std::tie(row, col) = std::pair(r, c);
    if (a[row][col] == 0.0L) return std::nullopt;
    std::swap(a[step], a[row]);
    for (auto& line : a) std::swap(line[step], line[col]);
    std::swap(column[step], column[col]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == step) continue;
      const Real part = a[r][step] / a[step][step];
      for (std::size_t c = step; c <= n; ++c) a[r][c] -= part * a[step][c];
    }
  }
  std::vector<Real> out(n);
  for (std::size_t r = 0; r < n; ++r) out[column[r]] = a[r][n] / a[r][r];
  return out;
}

/// Move, turn and engagement as nine numbers.
HoldMove move_from(const std::array<double, 9>& u) { return {{u[0], u[1], u[2]}, {u[3], u[4], u[5]}, {u[6], u[7], u[8]}}; }

double gap_by(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move, Sabotage sabotage) {
  const Vec3 arm = sabotage == Sabotage::no_arms ? Vec3(0.0) : plane.arm;
  double gap = plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, arm));
  if (!plane.cutting) return gap;
  if (sabotage == Sabotage::scalar_engagement) return gap + move.engagement.x - glm::dot(plane.normal, problem.engaged);
  gap += glm::dot(plane.normal, move.engagement);
  return sabotage == Sabotage::engaged_forgotten ? gap : gap - glm::dot(plane.normal, problem.engaged);
}

/// Stationarity in every unknown and equality in every active plane. Unknowns in scaled units, which pivoting and roundings like:
/// micrometres of every length, 1e-4 rad, newtons.
class ActiveSet {
 public:
  ActiveSet(const HoldProblem& problem, const std::vector<HoldPlane>& planes, Sabotage sabotage)
      : problem_(&problem), planes_(&planes), sabotage_(sabotage) {}

  std::optional<HoldTruth> solve(std::uint32_t active) const {
    std::vector<std::size_t> on;
    for (std::size_t n = 0; n < planes_->size(); ++n)
      if (((active >> n) & 1u) != 0) on.push_back(n);
    const std::size_t size = 9 + 2 * on.size();  // then yields, then forces
    Rows a(size, std::vector<Real>(size + 1));
    const std::array<double, 9> wanted{
        problem_->target.x, problem_->target.y, problem_->target.z, problem_->turn.x, problem_->turn.y, problem_->turn.z, 0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < 9; ++k) {
      // Infinitely stiff: the unknown is what is wanted, whatever the forces.
      const double weight = k < 3 ? problem_->stiffness : k < 6 ? problem_->turn_stiffness : problem_->cutting_stiffness;
      const bool fixed = std::isinf(weight);
      a[k][k] = static_cast<Real>(fixed ? 1.0 : weight) * scale(k);
      a[k][size] = static_cast<Real>(fixed ? 1.0 : weight) * static_cast<Real>(wanted[k]);
      if (fixed) continue;
      for (std::size_t i = 0; i < on.size(); ++i) a[k][9 + on.size() + i] = -slope(on[i], k);
    }
    for (std::size_t i = 0; i < on.size(); ++i) {
      const HoldPlane& plane = (*planes_)[on[i]];
      const double yield = sabotage_ == Sabotage::no_yield ? 1e-3 * plane.yield : plane.yield;
      a[9 + i][9 + i] = 1e-6L;  // y = yield f
      a[9 + i][9 + on.size() + i] = -static_cast<Real>(yield);
      std::vector<Real>& row = a[9 + on.size() + i];
      for (std::size_t k = 0; k < 9; ++k) row[k] = slope(on[i], k) * scale(k);
      row[9 + i] = 1e-6L;
      row[size] = -static_cast<Real>(gap_by(*problem_, plane, {}, sabotage_));
    }
    for (auto& row : a) {
      Real most = 0.0L;
      for (std::size_t c = 0; c < size; ++c) most = std::max(most, std::abs(row[c]));
      for (Real& value : row) value /= most;
    }
    const auto found = eliminate(std::move(a));
    if (!found) return std::nullopt;
    return checked(*found, on);
  }

 private:
  static Real scale(std::size_t k) { return k >= 3 && k < 6 ? 1e-4L : 1e-6L; }
  /// How the gap of a plane answers to one unknown: two values of the definition.
  Real slope(std::size_t plane, std::size_t k) const {
    std::array<double, 9> unit{};
    unit[k] = 1.0;
    HoldPlane bare = (*planes_)[plane];
    bare.gap = 0.0;
    HoldProblem still = *problem_;
    still.engaged = Vec3(0.0);
    return static_cast<Real>(gap_by(still, bare, move_from(unit), sabotage_));
  }
  [[nodiscard]] bool springs(const HoldPlane& plane) const { return plane.both_ways && sabotage_ != Sabotage::one_way; }
  /// Nobody pulls and nobody is broken, but for springs, which always take part.
  std::optional<HoldTruth> checked(const std::vector<Real>& found, const std::vector<std::size_t>& on) const {
    std::array<double, 9> u{};
    for (std::size_t k = 0; k < 9; ++k) u[k] = static_cast<double>(found[k] * scale(k));
    HoldTruth out{move_from(u), std::vector<double>(planes_->size())};
    for (std::size_t i = 0; i < on.size(); ++i) {
      out.forces[on[i]] = static_cast<double>(found[9 + on.size() + i]);
      if (out.forces[on[i]] < 0.0 && !springs((*planes_)[on[i]])) return std::nullopt;
    }
    for (std::size_t n = 0; n < planes_->size(); ++n)
      if (std::ranges::find(on, n) == on.end() &&
          (springs((*planes_)[n]) || gap_by(*problem_, (*planes_)[n], out.move, sabotage_) < -kTightTolerance))
        return std::nullopt;
    return out;
  }

  const HoldProblem* problem_;
  const std::vector<HoldPlane>* planes_;
  Sabotage sabotage_;
};

}  // namespace

double gap_of(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move) {
  return gap_by(problem, plane, move, Sabotage::none);
}

std::optional<HoldTruth> enumerate(const HoldProblem& problem, const std::vector<HoldPlane>& planes, Sabotage sabotage) {
  const ActiveSet sets(problem, planes, sabotage);
  for (std::uint32_t active = 0; active < (1u << planes.size()); ++active)
    if (auto truth = sets.solve(active)) return truth;
  return std::nullopt;
}

HoldProblem random_problem(std::uint64_t n) {
  const auto number = [&](std::uint64_t i) { return uniform11(21, 100 * n + i); };
  HoldProblem out;
  out.target = 1e-3 * glm::normalize(Vec3(0.7 * number(0), 0.7 * number(1), -1.0)) * (1.0 + 0.5 * number(2));
  out.turn = 0.05 * Vec3(number(3), number(4), number(5));
  out.engaged = 1e-4 * Vec3(number(6), number(7), number(8));
  out.stiffness = 5000.0 + 3000.0 * number(9);
  out.turn_stiffness = 20.0 + 15.0 * number(10);
  out.cutting_stiffness = 1e5 * std::pow(10.0, 0.5 * number(11));
  out.tolerance = kTightTolerance;
  return out;
}

std::vector<HoldPlane> random_planes(std::uint64_t n, std::size_t count) {
  const bool jammed = n % 3 == 0 && count < 10;
  std::vector<HoldPlane> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [&](std::uint64_t k) { return uniform11(22, 100'000 * n + 20 * i + k); };
    out[i].normal = glm::normalize(Vec3(number(0), number(1), jammed ? number(2) : 0.8 + 0.6 * number(2)));
    out[i].arm = 0.02 * Vec3(number(3), number(4), number(5));
    out[i].gap = 4e-4 * (number(6) + (jammed ? -0.9 : 0.8));
    out[i].yield = kLeastYield * std::pow(10.0, 1.0 + number(7));
    out[i].cutting = number(8) < 0.0;
    out[i].point = static_cast<std::uint32_t>(i);
  }
  return out;
}

std::optional<HoldPlane> ListedCandidates::most_violated(const HoldProblem& problem, const HoldMove& move,
                                                         std::span<const HoldPlane> kept) noexcept {
  double worst = -problem.tolerance;
  std::optional<HoldPlane> out;
  for (const HoldPlane& plane : *planes_) {
    if (std::ranges::find(kept, plane.point, &HoldPlane::point) != kept.end()) continue;
    const double gap = gap_of(problem, plane, move);
    if (gap >= worst) continue;
    worst = gap;
    out = plane;
  }
  return out;
}

}  // namespace burrhole::hold_test
