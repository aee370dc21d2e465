// The loads of friction against Coulomb's law itself: at the move that the law returns, each sliding point has its load against its
// displacement, springs and planes balance all loads, and no other move has less energy.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "core/base/spd.h"
#include "core/contact/friction.h"
#include "core/contact/hold_solver.h"

using namespace burrhole;

namespace {

constexpr double kMu = 0.3;
constexpr double kSettled = 1e-12;  // [m] residual of the law

double number(std::uint64_t seed, std::uint64_t n, double lo, double hi) { return lo + (hi - lo) * uniform01(seed, n); }
Vec3 any_vector(std::uint64_t seed, std::uint64_t n) {
  return {number(seed, 3 * n, -1.0, 1.0), number(seed, 3 * n + 1, -1.0, 1.0), number(seed, 3 * n + 2, -1.0, 1.0)};
}
Vec3 along_plane(const Vec3& v, const Vec3& normal) { return v - normal * glm::dot(v, normal); }

/// Springs, planes and the free move of one problem, with its points.
struct Case {
  std::vector<PressedPoint> points;
  Matrix6 planes{};
  bool with_planes = false;
  TangentialProblem problem;

  Case(std::uint64_t seed, bool spinning, std::size_t count) : with_planes(seed % 2 == 0) {
    for (std::size_t n = 0; n < count; ++n) {
      const bool wall = n % 5 == 4;
      const Vec3 arm = 6e-3 * any_vector(seed, 10 + n) * Vec3(1.0, 1.0, wall ? 1.0 : 0.1);
      const Vec3 normal = glm::normalize(wall ? any_vector(seed, 100 + n) : Vec3(0.0, 0.0, 1.0) + 0.05 * any_vector(seed, 100 + n));
      points.push_back({.point = static_cast<std::uint32_t>(n), .arm = arm, .normal = normal, .load = number(seed, 900 + n, 0.1, 3.0)});
      const Vec3 lever = glm::cross(arm, normal);
      const Vector6 row{normal.x, normal.y, normal.z, lever.x, lever.y, lever.z};
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t c = 0; c <= r; ++c) planes[r][c] += 2e6 * row[r] * row[c];
    }
    problem.stiffness = 15e3;
    problem.turn_stiffness = 60.0;
    problem.spin = spinning ? Vec3(0.0, 0.0, -104.7) : Vec3(0.0);
    const double size = std::pow(10.0, number(seed, 1, -7.0, -3.3));
    problem.free = {size * any_vector(seed, 2), 100.0 * size * any_vector(seed, 3)};
    problem.points = points;
    problem.planes = with_planes ? &planes : nullptr;
  }
  Case(const Case&) = delete;
  Case& operator=(const Case&) = delete;

  [[nodiscard]] Vec3 displacement(const PressedPoint& point, const SmallMove& move) const {
    return along_plane(move.at(point.arm) + problem.dt * glm::cross(problem.spin, point.arm), point.normal);
  }
  [[nodiscard]] Vector6 pull(const SmallMove& move) const {
    const Vec3 off = problem.free.translation - move.translation, turn = problem.free.turn - move.turn;
    const Vector6 x{off.x, off.y, off.z, turn.x, turn.y, turn.z};
    Vector6 out{};
    for (std::size_t r = 0; r < 6; ++r) {
      out[r] = (r < 3 ? problem.stiffness : problem.turn_stiffness) * x[r];
      for (std::size_t c = 0; with_planes && c < 6; ++c) out[r] += planes[std::max(r, c)][std::min(r, c)] * x[c];
    }
    return out;
  }
  /// [J] of springs, planes and friction.
  [[nodiscard]] double energy(const SmallMove& move) const {
    const Vec3 off = problem.free.translation - move.translation, turn = problem.free.turn - move.turn;
    const Vector6 force = pull(move), x{off.x, off.y, off.z, turn.x, turn.y, turn.z};
    double out = 0.0;
    for (std::size_t k = 0; k < 6; ++k) out += 0.5 * force[k] * x[k];
    for (const PressedPoint& point : points) out += kMu * point.load * glm::length(displacement(point, move));
    return out;
  }
  [[nodiscard]] double limits() const {
    double out = 0.0;
    for (const PressedPoint& point : points) out += kMu * point.load;
    return out;
  }
};

Friction law_of(double coefficient) {
  auto made = Friction::create({.static_coefficient = coefficient, .kinetic_coefficient = coefficient});
  REQUIRE(made.ok());
  return *made;
}

/// [J] by which the best of many moves near `move` has less energy than it.
double gained_nearby(const Case& problem, const SmallMove& move, std::uint64_t seed) {
  double most = 0.0;
  const double here = problem.energy(move);
  for (std::uint64_t n = 0; n < 300; ++n) {
    const double size = std::pow(10.0, number(seed, 5000 + n, -9.0, -4.0));
    const Vec3 by = size * any_vector(seed, 2000 + n), turn = 100.0 * size * any_vector(seed, 4000 + n);
    most = std::max(most, here - problem.energy({move.translation + by, move.turn + turn}));
  }
  return most;
}

}  // namespace

TEST_CASE("friction: no move near the one found has less energy, at rest and in spin, with and without planes") {
  int noticed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    const Case problem(seed, seed % 3 == 0, 1 + seed % 32);
    Friction law = law_of(kMu);
    const TangentialLoads found = law.loads(problem.problem);
    // A residual of 1e-12 m has at most the energy of all loads along it; ten times that for the turn at the longest arm and rounding.
    const double enough = 10.0 * kSettled * problem.limits() + 1e-15 * std::abs(problem.energy(found.move));
    CHECK(gained_nearby(problem, found.move, seed) < enough);
    // Sabotage: a coefficient that is a third too large. Where all points rest it changes nothing.
    Friction wrong = law_of(4.0 / 3.0 * kMu);
    noticed += gained_nearby(problem, wrong.loads(problem.problem).move, seed) > enough ? 1 : 0;
  }
  CHECK(noticed > 100);
}

TEST_CASE("friction: in spin each load is mu N against the displacement at the move found, and they balance springs and planes") {
  int judged = 0, noticed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    CAPTURE(seed);
    const Case problem(seed, true, 1 + seed % 32);
    Friction law = law_of(kMu);
    const TangentialLoads found = law.loads(problem.problem);
    Vec3 force(0.0), torque(0.0);
    double tolerance = 1e-9 * problem.limits();
    for (const PressedPoint& point : problem.points) {
      const Vec3 u = problem.displacement(point, found.move);
      const Vec3 load = -kMu * point.load * u / std::max(glm::length(u), 1e-300);
      force += load;
      torque += glm::cross(point.arm, load);
      // A residual of the move turns a load by this much; a point at rest has any load up to its limit.
      tolerance += kMu * point.load * std::min(2.0, 3.0 * kSettled / glm::length(u));
    }
    const Vector6 pull = problem.pull(found.move);
    // Planes of up to 6e7 N/m multiply the rounding of moves of 5e-4 m.
    const double rounding = 1e-7;
    CHECK(glm::length(found.on_tool.force + Vec3(pull[0], pull[1], pull[2])) < rounding);
    CHECK(glm::length(found.on_tool.torque + Vec3(pull[3], pull[4], pull[5])) < rounding);
    CHECK(glm::length(found.on_tool.force - force) < tolerance);
    CHECK(glm::length(found.on_tool.torque - torque) < 0.02 * tolerance);
    // Sabotage: a coefficient that is off by one part in a thousand.
    if (tolerance > 1e-4 * glm::length(force)) continue;
    ++judged;
    noticed += glm::length(found.on_tool.force - 1.001 * force) > tolerance ? 1 : 0;
  }
  CHECK(judged > 150);
  CHECK(noticed == judged);
}

TEST_CASE("hold solver: its stiffness of planes predicts how the tool follows its target, with and without engagement") {
  for (const bool cutting : {false, true})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      CAPTURE(seed);
      class None final : public HoldCandidates {
       public:
        std::optional<HoldPlane> most_violated(const HoldProblem&, const HoldMove&, std::span<const HoldPlane>) noexcept override {
          return {};
        }
      } none;
      HoldProblem problem{.target = Vec3(0.0, 0.0, -2e-3), .stiffness = 5e3, .turn_stiffness = 20.0, .cutting_stiffness = 140e3};
      const auto solved = [&](const HoldProblem& asked, HoldSolver& solver) {
        for (std::uint32_t n = 0; n < 5; ++n) {
          const Vec3 normal = glm::normalize(Vec3(0.0, 0.0, 1.0) + 0.3 * any_vector(seed, 50 + n));
          solver.add({.normal = normal, .arm = 5e-3 * any_vector(seed, 10 + n), .yield = 1e-7, .cutting = cutting && n < 3, .point = n});
        }
        return solver.solve(asked, none);
      };
      HoldSolver solver, moved_solver;
      const HoldMove before = solved(problem, solver);
      const Vec3 by = 1e-8 * any_vector(seed, 1), turn = 1e-6 * any_vector(seed, 2);
      HoldProblem asked = problem;
      asked.target += by;
      asked.turn += turn;
      const HoldMove after = solved(asked, moved_solver);
      if (solver.planes().size() != moved_solver.planes().size()) continue;  // a plane let go between
      const auto predicted = [&](std::span<const HoldPlane> planes) {
        Matrix6 whole = stiffness_of(problem, planes);
        for (std::size_t n = 0; n < 6; ++n) whole[n][n] += n < 3 ? problem.stiffness : problem.turn_stiffness;
        const Vec3 f = problem.stiffness * by, t = problem.turn_stiffness * turn;
        return solve_spd(whole, {f.x, f.y, f.z, t.x, t.y, t.z});
      };
      const auto missed = [&](const Vector6& x) {
        return glm::length(after.translation - before.translation - Vec3(x[0], x[1], x[2])) +
               5e-3 * glm::length(after.turn - before.turn - Vec3(x[3], x[4], x[5]));
      };
      CHECK(missed(predicted(solver.planes())) < 1e-14);  // roundings of moves of 2 mm, times the stiffness of planes over that of springs
      CHECK(missed(predicted(solver.planes().first(solver.planes().size() - 1))) > 1e-12);  // sabotage: a plane is left out
    }
}
