#include "core/contact/hold_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

constexpr int kMaxSteps = 48;        // of Newton's method; one to three are usual
constexpr int kMaxHalvings = 40;     // of a line search
constexpr double kFarEnough = 0.5;   // [-] a line search ends below this fraction of the initial slope
constexpr double kRounding = 1e-15;  // [-] of a gap: nearer to its surface than this, a plane is neither pressed nor free
// [-] of the springs' compliance: the least yield; stiffer bone has it. A force is a gap over a yield, and has 7 digits at this one.
constexpr double kLeastYield = 1e-9;

/// Gap of a plane after a move, without its yield.
double gap_after(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move) noexcept {
  const Vec3 engaging = plane.cutting ? move.engagement - problem.engaged : Vec3(0.0);
  return plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, plane.arm) + engaging);
}

/// [N/m] Of bone under a plane with that lever (arm x normal).
double stiffness_under(const HoldProblem& problem, const HoldPlane& plane, const Vec3& lever) noexcept {
  const double compliance = 1.0 / problem.stiffness + glm::dot(lever, lever) / problem.turn_stiffness;
  return 1.0 / std::max(plane.yield, kLeastYield * compliance);
}

/// The kept planes in the unknowns z, the move from the unloaded one: translation, turn and, if n is 9, engagement. At any z the best yield
/// is y_i = max(0, -c_i), so the energy is
///     E(z) = 1/2 z W z + sum of min(0, c_i)^2 / (2 yield_i),   c_i = gap_i + row_i . z,   W = (K, K_r, K_cut).
/// It is convex with a continuous slope, and quadratic where the pressed planes, those with c_i < 0, stay the same.
template <std::size_t n>
class PressedPlanes {
 public:
  PressedPlanes(const HoldProblem& problem, std::span<const HoldPlane> planes) noexcept : count_(planes.size()) {
    const bool turns = !std::isinf(problem.turn_stiffness);
    for (std::size_t k = 0; k < n; ++k)
      weight_[k] = k < 3 ? problem.stiffness : k >= 6 ? problem.cutting_stiffness : turns ? problem.turn_stiffness : 1.0;
    const HoldMove unloaded{problem.target, problem.turn, Vec3(0.0)};
    for (std::size_t i = 0; i < count_; ++i) {
      const HoldPlane& plane = planes[i];
      const Vec3 lever = turns ? glm::cross(plane.arm, plane.normal) : Vec3(0.0);
      const Vec3 engages = plane.cutting ? plane.normal : Vec3(0.0);
      for (std::size_t k = 0; k < n; ++k) {
        const auto axis = static_cast<Vec3::length_type>(k % 3);
        row_[i][k] = k < 3 ? plane.normal[axis] : k < 6 ? lever[axis] : engages[axis];
      }
      gap_[i] = gap_after(problem, plane, unloaded);
      stiffness_[i] = stiffness_under(problem, plane, lever);
      spring_[i] = plane.both_ways;
      pressed_[i] = true;
    }
  }

  /// Finds the minimum by Newton's method, from the minimum with all planes pressed.
  void minimise() noexcept {
    at_ = newton_point();
    now_ = gaps(at_);
    bool arrived = true;
    for (int step = 0; step < kMaxSteps && (press() || !arrived); ++step) {
      const VectorN<n> to = newton_point();
      const Gaps then = gaps(to);
      const double part = line_search(to, then);
      if (part == 0.0) break;  // the current point is the minimum, to rounding
      arrived = part == 1.0;
      for (std::size_t k = 0; k < n; ++k) at_[k] = arrived ? to[k] : at_[k] + part * (to[k] - at_[k]);
      for (std::size_t i = 0; i < count_; ++i) now_[i] = arrived ? then[i] : now_[i] + part * (then[i] - now_[i]);
    }
  }

  [[nodiscard]] double force(std::size_t i) const noexcept {
    return spring_[i] ? -now_[i] * stiffness_[i] : std::max(0.0, -now_[i] * stiffness_[i]);
  }

  /// @returns the plane without which the energy falls least, with all planes pressed by those forces [N]. Without plane i, of stiffness k
  /// and row r, its gap grows by 1 / (1 - k r H^-1 r), H the second derivative, and the energy falls by f^2 / 2k times that. Springs stay; the
  /// number of planes if all are springs.
  [[nodiscard]] std::size_t least_needed(std::span<const HoldPlane> planes) const noexcept {
    const MatrixN<n> matrix = factors();
    std::size_t least = count_;
    double falls = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count_; ++i) {
      if (spring_[i]) continue;
      const VectorN<n> gives = solve_factored(matrix, row_[i]);
      double share = 0.0;
      for (std::size_t k = 0; k < n; ++k) share += stiffness_[i] * row_[i][k] * gives[k];
      const double by = planes[i].force * planes[i].force / (stiffness_[i] * std::max(1.0 - share, kLeastYield));
      if (!(by < falls)) continue;
      falls = by;
      least = i;
    }
    return least;
  }

 private:
  using Gaps = std::array<double, kMaxHoldPlanes>;

  [[nodiscard]] Gaps gaps(const VectorN<n>& z) const noexcept {
    Gaps out;
    for (std::size_t i = 0; i < count_; ++i) {
      out[i] = gap_[i];
      for (std::size_t k = 0; k < n; ++k) out[i] += row_[i][k] * z[k];
    }
    return out;
  }

  /// Updates the pressed planes. @returns whether any changed.
  bool press() noexcept {
    bool changed = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const double rounding = kRounding * std::abs(gap_[i]);
      const bool pressed = spring_[i] || now_[i] < (pressed_[i] ? rounding : -rounding);
      changed = changed || pressed != pressed_[i];
      pressed_[i] = pressed;
    }
    return changed;
  }

  /// Adds the slope of the pressed planes' energy, times -1.
  void add_push(const Gaps& gaps, VectorN<n>& out) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!pressed_[i]) continue;
      const double force = -stiffness_[i] * gaps[i];
      for (std::size_t k = 0; k < n; ++k) out[k] += force * row_[i][k];
    }
  }

  /// @returns the factors of the energy's second derivative.
  [[nodiscard]] MatrixN<n> factors() const noexcept {
    MatrixN<n> matrix{};
    for (std::size_t k = 0; k < n; ++k) matrix[k][k] = weight_[k];
    for (std::size_t i = 0; i < count_; ++i) {
      if (!pressed_[i]) continue;
      for (std::size_t r = 0; r < n; ++r) {
        const double weighted = stiffness_[i] * row_[i][r];
        for (std::size_t c = 0; c <= r; ++c) matrix[r][c] += weighted * row_[i][c];
      }
    }
    factor_spd(matrix);
    return matrix;
  }

  /// @returns the minimum while the pressed planes stay the same.
  [[nodiscard]] VectorN<n> newton_point() const noexcept {
    const MatrixN<n> matrix = factors();
    VectorN<n> push{};
    add_push(gap_, push);
    VectorN<n> z = solve_factored(matrix, push);
    // Bone is far stiffer than the springs, so one step of refinement restores the digits that they have lost.
    for (std::size_t k = 0; k < n; ++k) push[k] = -weight_[k] * z[k];
    add_push(gaps(z), push);
    const VectorN<n> rest = solve_factored(matrix, push);
    for (std::size_t k = 0; k < n; ++k) z[k] += rest[k];
    return z;
  }

  /// @returns the part of the way from the current point at which the energy is near its least; 1 where that is good enough, 0 where the
  /// way does not lead down.
  [[nodiscard]] double line_search(const VectorN<n>& to, const Gaps& then) const noexcept {
    double slope_here = 0.0, curvature = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      slope_here += weight_[k] * at_[k] * (to[k] - at_[k]);
      curvature += weight_[k] * (to[k] - at_[k]) * (to[k] - at_[k]);
    }
    const auto slope = [&](double part) {
      double out = slope_here + part * curvature;
      for (std::size_t i = 0; i < count_; ++i) {
        const double gap = now_[i] + part * (then[i] - now_[i]);
        if (gap < 0.0 || spring_[i]) out += stiffness_[i] * gap * (then[i] - now_[i]);
      }
      return out;
    };
    const double start = slope(0.0);
    if (!(start < 0.0)) return 0.0;
    const double enough = -kFarEnough * start;
    double low = 0.0, high = 1.0, part = 1.0;
    for (int step = 0; step < kMaxHalvings; ++step) {
      const double now = slope(part);
      if (std::abs(now) <= enough || (part == 1.0 && now < 0.0)) break;
      (now < 0.0 ? low : high) = part;
      part = 0.5 * (low + high);
    }
    return part;
  }

  std::size_t count_;
  VectorN<n> weight_{}, at_{};
  std::array<VectorN<n>, kMaxHoldPlanes> row_;
  Gaps gap_, stiffness_, now_;  // gap_: at z = 0; now_: at at_
  std::array<bool, kMaxHoldPlanes> spring_, pressed_;
};

/// [J] Energy of springs and bone at the optimum of those planes.
double energy_at(const HoldProblem& problem, std::span<const HoldPlane> planes, const HoldMove& move) noexcept {
  const Vec3 off = move.translation - problem.target, turned = move.turn - problem.turn;
  double twice = problem.stiffness * glm::dot(off, off) + problem.cutting_stiffness * glm::dot(move.engagement, move.engagement);
  if (!std::isinf(problem.turn_stiffness)) twice += problem.turn_stiffness * glm::dot(turned, turned);
  for (const HoldPlane& plane : planes) twice += plane.yield * plane.force * plane.force;
  return 0.5 * twice;
}

template <std::size_t n>
void find_forces(const HoldProblem& problem, std::span<HoldPlane> planes) noexcept {
  PressedPlanes<n> pressed(problem, planes);
  pressed.minimise();
  for (std::size_t i = 0; i < planes.size(); ++i) planes[i].force = pressed.force(i);
}

bool any_cuts(std::span<const HoldPlane> planes) noexcept { return std::ranges::any_of(planes, &HoldPlane::cutting); }

/// @returns the plane that is needed least, of planes with the forces of an optimum.
std::size_t least_needed(const HoldProblem& problem, std::span<const HoldPlane> planes) noexcept {
  return any_cuts(planes) ? PressedPlanes<9>(problem, planes).least_needed(planes) : PressedPlanes<6>(problem, planes).least_needed(planes);
}

}  // namespace

Matrix6 stiffness_of(const HoldProblem& problem, std::span<const HoldPlane> planes) noexcept {
  // Engagement first, so that its elimination leaves the stiffness against a move.
  MatrixN<9> whole{};
  for (std::size_t n = 0; n < 3; ++n) whole[n][n] = problem.cutting_stiffness;
  for (const HoldPlane& plane : planes) {
    const Vec3 lever = glm::cross(plane.arm, plane.normal), engages = plane.cutting ? plane.normal : Vec3(0.0);
    const VectorN<9> row{engages.x, engages.y, engages.z, plane.normal.x, plane.normal.y, plane.normal.z, lever.x, lever.y, lever.z};
    const double stiffness = stiffness_under(problem, plane, lever);
    for (std::size_t r = plane.cutting ? 0 : 3; r < 9; ++r)
      for (std::size_t c = plane.cutting ? 0 : 3; c <= r; ++c) whole[r][c] += stiffness * row[r] * row[c];
  }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t r = k + 1; r < 9; ++r) {
      const double part = whole[r][k] / whole[k][k];
      for (std::size_t c = k + 1; c <= r; ++c) whole[r][c] -= part * whole[c][k];
    }
  Matrix6 out{};
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t c = 0; c <= r; ++c) out[r][c] = whole[r + 3][c + 3];
  return out;
}

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

void HoldSolver::add(const HoldPlane& plane) noexcept {
  if (count_ == kMaxHoldPlanes) {
    const auto carries = [](const HoldPlane& kept) { return kept.both_ways ? std::numeric_limits<double>::infinity() : kept.force; };
    const auto least = std::ranges::min_element(planes(), {}, carries);
    std::copy(least + 1, planes().end(), least);
    --count_;
  }
  planes_[count_] = plane;
  planes_[count_++].force = 0.0;
}

void HoldSolver::settle(const HoldProblem& problem) noexcept {
  if (count_ == 0) return;
  if (any_cuts(planes()))
    find_forces<9>(problem, planes());
  else
    find_forces<6>(problem, planes());
  refresh([](const HoldPlane& plane) { return plane.force > 0.0 || plane.both_ways; });
}

double HoldSolver::deepest() const noexcept {
  double out = 0.0;
  for (const HoldPlane& plane : planes())
    if (!plane.both_ways) out = std::max(out, plane.yield * plane.force);
  return out;
}

HoldMove HoldSolver::solve(const HoldProblem& problem, HoldCandidates& candidates) noexcept {
  settle(problem);
  converged_ = false;
  for (rounds_ = 0; rounds_ < kMaxHoldRounds; ++rounds_) {
    const HoldMove move = move_of(problem);
    const auto found = candidates.most_violated(problem, move, planes());
    // Where no more planes fit, one that is no deeper in bone than they are would only share their load.
    if (!found || (count_ == kMaxHoldPlanes && gap_after(problem, *found, move) >= -deepest())) {
      converged_ = true;
      return move;
    }
    if (count_ == kMaxHoldPlanes) {
      // It takes the room of the plane that is needed least. If the energy does not rise, that one was needed
      // more: they would take turns. Energies are known to rounding, so kMaxHoldRounds remains the bound.
      const auto kept = planes_;
      const double energy = energy_at(problem, planes(), move);
      const std::size_t least = least_needed(problem, planes());
      if (least == count_) break;
      planes_[least] = *found;
      settle(problem);
      if (energy_at(problem, planes(), move_of(problem)) > energy) continue;
      planes_ = kept;
      count_ = kMaxHoldPlanes;
      break;
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
