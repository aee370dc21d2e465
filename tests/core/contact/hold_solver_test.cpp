// hold_solver against every active set tried in turn.
#include "core/contact/hold_solver.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

constexpr double kTolerance = 1e-12;  ///< [m] asked of the solver
constexpr HoldProblem kProblem{Vec3(0.0, 0.0, -2e-3), 5000.0, 100e3};

/// Unknowns (t, s) with weights K, K, K, K_cut; row i asks N_i . t + c_i s >= offset_i.
struct Exact {
  Vec3 translation;
  double engagement;
  std::vector<double> forces;
};

/// Solves a small dense system by elimination with pivoting; nothing when it is singular.
std::optional<std::vector<double>> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
    if (std::abs(a[pivot][c]) < 1e-14) return std::nullopt;
    std::swap(a[c], a[pivot]);
    std::swap(b[c], b[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double f = a[r][c] / a[c][c];
      for (std::size_t k = c; k < n; ++k) a[r][k] -= f * a[c][k];
      b[r] -= f * b[c];
    }
  }
  for (std::size_t c = 0; c < n; ++c) b[c] /= a[c][c];
  return b;
}

/// The one active set whose multipliers push and whose point violates no plane.
std::optional<Exact> enumerate(const HoldProblem& problem, const std::vector<HoldPlane>& planes) {
  for (unsigned set = 0; set < (1u << planes.size()); ++set) {
    std::vector<std::size_t> active;
    for (std::size_t i = 0; i < planes.size(); ++i)
      if ((set >> i) & 1u) active.push_back(i);
    std::vector<std::vector<double>> a;
    std::vector<double> b;
    for (const std::size_t i : active) {
      std::vector<double> row;
      for (const std::size_t j : active)
        row.push_back(glm::dot(planes[i].normal, planes[j].normal) / problem.stiffness +
                      (planes[i].cutting && planes[j].cutting ? 1.0 / problem.cutting_stiffness : 0.0));
      a.push_back(row);
      b.push_back(planes[i].offset - glm::dot(planes[i].normal, problem.target));
    }
    const auto lambda = solve(a, b);
    if (!lambda) continue;
    Exact exact{problem.target, 0.0, std::vector<double>(planes.size(), 0.0)};
    bool good = true;
    for (std::size_t n = 0; n < active.size(); ++n) {
      const HoldPlane& plane = planes[active[n]];
      good = good && (*lambda)[n] >= 0.0;
      exact.forces[active[n]] = (*lambda)[n];
      exact.translation += plane.normal * ((*lambda)[n] / problem.stiffness);
      if (plane.cutting) exact.engagement += (*lambda)[n] / problem.cutting_stiffness;
    }
    for (const HoldPlane& plane : planes)
      good = good && glm::dot(plane.normal, exact.translation) + (plane.cutting ? exact.engagement : 0.0) >= plane.offset - 1e-13;
    if (good) return exact;
  }
  return std::nullopt;
}

/// 1 to 4 planes that face the hand's push more or less, so that there is always a way out upwards.
std::vector<HoldPlane> random_planes(std::uint64_t n) {
  std::vector<HoldPlane> planes(1 + mix64(n) % 4);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::uint64_t at = 100 * n + 10 * i;
    planes[i].normal = glm::normalize(Vec3(uniform11(1, at), uniform11(1, at + 1), 0.3 + uniform01(1, at + 2)));
    planes[i].offset = 0.5e-3 * uniform11(1, at + 3);
    planes[i].cutting = uniform01(1, at + 4) < 0.5;
  }
  return planes;
}

}  // namespace

TEST_CASE("hold solver: meets the KKT conditions and equals the best of all active sets") {
  int converged = 0;
  constexpr int kTrials = 300;
  for (std::uint64_t n = 0; n < kTrials; ++n) {
    CAPTURE(n);
    std::vector<HoldPlane> planes = random_planes(n);
    const auto exact = enumerate(kProblem, planes);
    REQUIRE(exact);
    const HoldSolution solution = solve_hold(kProblem, planes, kTolerance);
    if (!solution.converged) continue;
    ++converged;
    // A sweep that changes less than 1e-12 m stops; near-parallel normals contract by 0.95 a sweep at worst: 20 times that.
    const double near = 1e-10;  // [m]
    CHECK(glm::length(solution.translation - exact->translation) <= near);
    CHECK(std::abs(solution.engagement - exact->engagement) <= near);
    Vec3 pull = kProblem.stiffness * (solution.translation - kProblem.target);
    double cut = kProblem.cutting_stiffness * solution.engagement;
    for (const HoldPlane& plane : planes) {
      const double gap = glm::dot(plane.normal, solution.translation) + (plane.cutting ? solution.engagement : 0.0) - plane.offset;
      CHECK(plane.force >= 0.0);                   // bone never pulls
      CHECK(gap >= -near);                         // no plane is broken
      CHECK((plane.force == 0.0 || gap <= near));  // only planes that touch push
      pull -= plane.normal * plane.force;
      if (plane.cutting) cut -= plane.force;
    }
    CHECK(glm::length(pull) <= 1e-9);  // [N] the coupling balances the planes: kept by construction, roundings only
    CHECK(std::abs(cut) <= 1e-9);
  }
  CHECK(converged >= kTrials * 9 / 10);  // the rest are near-parallel: slow, and said to be so
}

TEST_CASE("hold solver: engaged depth is the force on cutting planes over K_cut") {
  for (const int count : {1, 3}) {
    std::vector<HoldPlane> planes(static_cast<std::size_t>(count), HoldPlane{.cutting = true});
    const HoldSolution solution = solve_hold(kProblem, planes, kTolerance);
    REQUIRE(solution.converged);
    double force = 0.0;
    for (const HoldPlane& plane : planes) force += plane.force;
    // One plane at 0, hand 2 mm below: springs in series, F = depth / (1/K + 1/K_cut), however many points share it.
    const double expected = 2e-3 / (1.0 / 5000.0 + 1.0 / 100e3);
    CHECK(std::abs(force - expected) <= 1e-6);
    CHECK(std::abs(solution.engagement - expected / 100e3) <= 1e-11);
    CHECK(std::abs(solution.translation.z + solution.engagement) <= 1e-11);
  }
}

TEST_CASE("hold solver: without planes, or with planes out of reach, the tool goes where the hand wants it") {
  const HoldSolution free = solve_hold(kProblem, {}, kTolerance);
  CHECK(free.converged);
  CHECK(free.translation == kProblem.target);
  CHECK(free.engagement == 0.0);
  std::array<HoldPlane, 1> below{HoldPlane{.offset = -3e-3}};
  CHECK(solve_hold(kProblem, below, kTolerance).translation == kProblem.target);
  CHECK(below[0].force == 0.0);
}

TEST_CASE("hold solver: two hard planes that cannot both hold end within the bound, finite and not converged") {
  std::array<HoldPlane, 2> planes{HoldPlane{.normal = Vec3(0.0, 0.0, 1.0), .offset = 1e-3},
                                  HoldPlane{.normal = Vec3(0.0, 0.0, -1.0), .offset = 1e-3}};
  const HoldSolution solution = solve_hold(kProblem, planes, kTolerance);
  CHECK_FALSE(solution.converged);
  CHECK(solution.sweeps == kMaxHoldSweeps);
  CHECK(is_finite(solution.translation));
  CHECK(std::abs(solution.translation.z) <= 1e-3 + 1e-9);  // between the two, which ask for +1 mm and -1 mm
  for (const HoldPlane& plane : planes) CHECK(std::isfinite(plane.force));
}

TEST_CASE("hold solver: a warm start gives the same answer in no more sweeps") {
  for (std::uint64_t n = 0; n < 100; ++n) {
    std::vector<HoldPlane> planes = random_planes(n);
    const HoldSolution cold = solve_hold(kProblem, planes, kTolerance);
    if (!cold.converged) continue;
    const HoldSolution again = solve_hold(kProblem, planes, kTolerance);
    CHECK(again.converged);
    CHECK(again.sweeps <= std::max(1, cold.sweeps));
    CHECK(glm::length(again.translation - cold.translation) <= 1e-10);  // as above
    // From forces of another problem.
    for (std::size_t i = 0; i < planes.size(); ++i) planes[i].force = 30.0 * uniform01(9, 10 * n + i);
    const HoldSolution moved = solve_hold(kProblem, planes, kTolerance);
    if (moved.converged) CHECK(glm::length(moved.translation - cold.translation) <= 1e-10);
  }
}
