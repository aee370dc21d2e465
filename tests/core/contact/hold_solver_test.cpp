// hold_solver against every active set tried in turn, each solved in the unknowns of its definition (hold_support.h).
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hold_support.h"

using namespace burrhole;
using namespace burrhole::hold_test;

namespace {

HoldMove solved(HoldSolver& solver, const HoldProblem& problem, const std::vector<HoldPlane>& planes) {
  ListedCandidates candidates(planes);
  return solver.solve(problem, candidates);
}

double force_of(const HoldSolver& solver, std::uint32_t point) {
  const auto found = std::ranges::find(solver.planes(), point, &HoldPlane::point);
  return found == solver.planes().end() ? 0.0 : found->force;
}

/// How far the solver's answer is from an oracle's, in parts of what its tolerance allows (see kAllowed...).
double disagreement(const HoldSolver& solver, const HoldMove& move, const HoldTruth& truth, std::size_t planes) {
  double force = 0.0;
  for (std::size_t n = 0; n < planes; ++n)
    force = std::max(force, std::abs(force_of(solver, static_cast<std::uint32_t>(n)) - truth.forces[n]));
  return std::max({glm::length(move.translation - truth.move.translation) / kAllowedLength,
                   glm::length(move.engagement - truth.move.engagement) / kAllowedLength,
                   glm::length(move.turn - truth.move.turn) / kAllowedTurn, force / kAllowedForce});
}

/// Pushed by 2 mm into a floor at z = 0 under the tool origin: nothing turns.
HoldProblem pushed_down() { return {.target = Vec3(0.0, 0.0, -2e-3), .stiffness = 5e3, .turn_stiffness = 20.0, .cutting_stiffness = 1e5}; }

}  // namespace

TEST_CASE("hold solver: equals the best of all active sets") {
  std::array<int, 8> loaded{};
  for (std::uint64_t n = 0; n < 300; ++n) {
    CAPTURE(n);
    const HoldProblem problem = random_problem(n);
    const std::vector<HoldPlane> planes = random_planes(n, 1 + mix64(n) % 7);
    const auto truth = enumerate(problem, planes);
    REQUIRE(truth);
    HoldSolver solver;
    const HoldMove move = solved(solver, problem, planes);
    CHECK(solver.converged());
    CHECK(disagreement(solver, move, *truth, planes.size()) <= 1.0);
    ++loaded[solver.planes().size()];
  }
  for (std::size_t n = 1; n <= 4; ++n) CHECK_MESSAGE(loaded[n] > 5, n);  // sets of many sizes were met
}

TEST_CASE("hold solver: bilateral springs take part in the best of all active sets, with force of either sign") {
  int pulling = 0, told = 0;
  for (std::uint64_t n = 0; n < 200; ++n) {
    CAPTURE(n);
    const HoldProblem problem = random_problem(n);
    std::vector<HoldPlane> planes = random_planes(n, 3 + mix64(n) % 4);
    HoldSolver solver;
    for (std::size_t k = 0; k < 2; ++k) {
      planes[k].both_ways = true;
      planes[k].cutting = false;
      planes[k].yield = 1e-4;  // 10 kN/m: a spring, not a wall
      solver.add(planes[k]);
    }
    const auto truth = enumerate(problem, planes);
    REQUIRE(truth);
    const HoldMove move = solved(solver, problem, planes);
    CHECK(solver.converged());
    CHECK(disagreement(solver, move, *truth, planes.size()) <= 1.0);
    if (std::min(truth->forces[0], truth->forces[1]) >= 0.0) continue;
    ++pulling;
    // Sabotage: the same as planes that only push are told.
    const auto one_way = enumerate(problem, planes, Sabotage::one_way);
    if (!one_way || disagreement(solver, move, *one_way, planes.size()) > 1.0) ++told;
  }
  CHECK(pulling > 50);
  CHECK(told == pulling);
}

TEST_CASE("hold solver: sabotaged twins disagree") {
  // Without the turn's lever arms, with one depth of engagement for all planes, with gaps that forget the engagement they were measured at.
  for (const Sabotage sabotage : {Sabotage::no_arms, Sabotage::scalar_engagement, Sabotage::engaged_forgotten, Sabotage::no_yield}) {
    CAPTURE(static_cast<int>(sabotage));
    int told = 0;
    for (std::uint64_t n = 0; n < 60; ++n) {
      const HoldProblem problem = random_problem(n);
      const std::vector<HoldPlane> planes = random_planes(n, 5);
      const auto truth = enumerate(problem, planes, sabotage);
      HoldSolver solver;
      const HoldMove move = solved(solver, problem, planes);
      told += !truth || disagreement(solver, move, *truth, planes.size()) > 100.0;
    }
    CHECK(told >= 30);  // where a set carries no load, or none that cuts, all twins are right
  }
}

TEST_CASE("hold solver: meets the conditions of an optimum among 300 candidates") {
  std::size_t most = 0;
  for (std::uint64_t n = 0; n < 100; ++n) {
    CAPTURE(n);
    const HoldProblem problem = random_problem(n);
    const std::vector<HoldPlane> planes = random_planes(n, 300);
    HoldSolver solver;
    const HoldMove move = solved(solver, problem, planes);
    REQUIRE(solver.converged());
    most = std::max(most, solver.planes().size());
    Vec3 force(0.0), torque(0.0), cut(0.0);
    for (const HoldPlane& plane : solver.planes()) {
      const Vec3 push = plane.force * plane.normal;
      CHECK(plane.force > 0.0);
      force += push;
      torque += glm::cross(plane.arm, push);
      if (plane.cutting) cut += push;
      // Touches after its yield; roundings of a system conditioned by up to 1e4 (compliance over yield), of lengths of 1e-3 m.
      CHECK(std::abs(gap_of(problem, plane, move) + plane.yield * plane.force) <= 1e-14);
    }
    for (const HoldPlane& plane : planes)
      if (force_of(solver, plane.point) == 0.0) CHECK(gap_of(problem, plane, move) >= -problem.tolerance);
    // Balance, kept by construction: roundings of some 10 N, 0.1 N m.
    CHECK(glm::length(problem.stiffness * (move.translation - problem.target) - force) <= 1e-11);
    CHECK(glm::length(problem.turn_stiffness * (move.turn - problem.turn) - torque) <= 1e-11);
    CHECK(glm::length(problem.cutting_stiffness * move.engagement - cut) <= 1e-11);
  }
  CHECK(most >= 5);
}

TEST_CASE("hold solver: forces are those of the planes kept, solved at once, to the last bit") {
  // The factor grows and shrinks with the planes: what was added and dropped on the way must not show.
  int loaded = 0, told = 0;
  for (std::uint64_t n = 0; n < 300; ++n) {
    CAPTURE(n);
    const HoldProblem problem = random_problem(n);
    HoldSolver solver, again, moved;
    (void)solved(solver, problem, random_planes(n, 2 + mix64(n) % 60));
    for (HoldPlane plane : solver.planes()) {
      again.add(plane);
      plane.gap -= 1e-9;
      moved.add(plane);
    }
    (void)solved(again, problem, {});
    (void)solved(moved, problem, {});
    REQUIRE(again.planes().size() == solver.planes().size());
    if (!solver.planes().empty()) ++loaded;
    for (std::size_t k = 0; k < again.planes().size(); ++k) CHECK(again.planes()[k].force == solver.planes()[k].force);
    if (!moved.planes().empty() && moved.planes()[0].force != solver.planes()[0].force) ++told;  // sabotage: gaps of another moment show
  }
  CHECK(loaded > 200);
  CHECK(told > 200);
}

TEST_CASE("hold solver: a warm start gives the same answer in fewer rounds") {
  int cold_rounds = 0, warm_rounds = 0;
  for (std::uint64_t n = 0; n < 100; ++n) {
    CAPTURE(n);
    HoldProblem problem = random_problem(n);
    const std::vector<HoldPlane> planes = random_planes(n, 40);
    HoldSolver warm;
    solved(warm, problem, planes);
    // The hand moves on, and half of the time what is kept has been refreshed with forces that mean nothing.
    problem.target += 2e-5 * Vec3(uniform11(7, n), uniform11(8, n), uniform11(9, n));
    if (n % 2 == 1)
      warm.refresh([&](HoldPlane& plane) {
        plane.force = 20.0 * uniform01(10, n + plane.point);
        return plane.point % 3 != 0;
      });
    HoldSolver cold;
    const HoldMove expected = solved(cold, problem, planes);
    const HoldMove move = solved(warm, problem, planes);
    REQUIRE(warm.converged());
    if (n % 2 == 0) {
      cold_rounds += cold.rounds();
      warm_rounds += warm.rounds();
    }
    HoldTruth truth{expected, std::vector<double>(planes.size())};
    for (std::size_t i = 0; i < planes.size(); ++i) truth.forces[i] = force_of(cold, static_cast<std::uint32_t>(i));
    CHECK(disagreement(warm, move, truth, planes.size()) <= 2.0);  // both within the tolerance of the truth
  }
  CHECK(4 * warm_rounds < cold_rounds);
}

TEST_CASE("hold solver: without planes within reach the tool goes where the hand wants it") {
  HoldProblem problem = pushed_down();
  problem.turn = Vec3(0.1, 0.2, 0.3);
  problem.engaged = Vec3(1e-4);
  HoldSolver solver;
  for (const std::vector<HoldPlane>& planes : {std::vector<HoldPlane>{}, std::vector<HoldPlane>{{.gap = 3e-3, .yield = 1e-7}}}) {
    const HoldMove move = solved(solver, problem, planes);
    CHECK(solver.converged());
    CHECK(solver.rounds() == 0);
    CHECK(move.translation == problem.target);
    CHECK(move.turn == problem.turn);
    CHECK(move.engagement == Vec3(0.0));
  }
}

TEST_CASE("hold solver: engagement is the force on cutting planes over K_cut and yields come on top") {
  for (const int count : {1, 2, 5, 20}) {
    CAPTURE(count);
    const double yield = 5e-7;
    std::vector<HoldPlane> planes;
    for (int n = 0; n < count; ++n) planes.push_back({.yield = yield, .cutting = true, .point = static_cast<std::uint32_t>(n)});
    HoldProblem problem = pushed_down();
    problem.tolerance = kTightTolerance;
    HoldSolver solver;
    const HoldMove move = solved(solver, problem, planes);
    REQUIRE(solver.converged());
    double force = 0.0;
    for (const HoldPlane& plane : solver.planes()) force += plane.force;
    // Springs in series: the hand's, the engagement that all planes share, and the planes' yields side by side.
    const double expected = 2e-3 / (1.0 / 5e3 + 1.0 / 1e5 + yield / count);
    CHECK(std::abs(force - expected) <= 1e-7);                                            // tolerance over yield, and roundings
    CHECK(std::abs(move.engagement.z * 1e5 - force) <= 1e-10);                            // F = K_cut e: the yields are no engagement
    CHECK(std::abs(-move.translation.z - force / 1e5 - yield * force / count) <= 1e-14);  // bone gives by e and by the yield
    // Equal planes do not stiffen beyond the engagement that they share.
    CHECK(force < 2e-3 / (1.0 / 5e3 + 1.0 / 1e5));
  }
}

TEST_CASE("hold solver: opposed walls of a slot add nothing to the engagement") {
  const auto floor_of = [](double wall_gap, bool walls) {
    std::vector<HoldPlane> planes{{.normal = Vec3(0.0, 0.0, 1.0), .yield = 5e-7, .cutting = true, .point = 0}};
    if (walls)
      for (const double side : {1.0, -1.0})
        planes.push_back({.normal = Vec3(side, 0.0, 0.0),
                          .arm = Vec3(-1e-3 * side, 0.0, 0.0),
                          .gap = wall_gap,
                          .yield = 5e-7,
                          .cutting = true,
                          .point = side > 0.0 ? 1u : 2u});
    return planes;
  };
  HoldSolver alone, pinched;
  const HoldMove without = solved(alone, pushed_down(), floor_of(0.0, false));
  const HoldMove with = solved(pinched, pushed_down(), floor_of(-1e-5, true));  // the blade is 20 um too wide
  CHECK(pinched.planes().size() == 3);
  CHECK(std::abs(force_of(pinched, 1) - 1e-5 / 5e-7) <= 1e-9);  // each wall yields by its own overlap: 20 N
  CHECK(std::abs(force_of(pinched, 1) - force_of(pinched, 2)) <= 1e-9);
  CHECK(glm::length(with.engagement - without.engagement) <= 1e-15);  // roundings of 1e-4 m
  CHECK(glm::length(with.translation - without.translation) <= 1e-15);
}

TEST_CASE("hold solver: infinitely stiff against turning is turning as the hand does") {
  for (std::uint64_t n = 0; n < 60; ++n) {
    CAPTURE(n);
    HoldProblem problem = random_problem(n);
    problem.turn_stiffness = std::numeric_limits<double>::infinity();
    const std::vector<HoldPlane> planes = random_planes(n, 5);
    const auto truth = enumerate(problem, planes);
    REQUIRE(truth);
    HoldSolver solver;
    const HoldMove move = solved(solver, problem, planes);
    CHECK(move.turn == problem.turn);
    CHECK(disagreement(solver, move, *truth, planes.size()) <= 1.0);
  }
}

TEST_CASE("hold solver: the force against the push never falls while pressing deeper") {
  // What is minimised is convex in the target, and its slope along the push is the force against it. (Of a force that is not along the
  // push, the size alone may fall.)
  int loaded = 0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    CAPTURE(n);
    HoldProblem problem = random_problem(n);
    const std::vector<HoldPlane> planes = random_planes(n, 30);
    const Vec3 push = glm::normalize(problem.target);
    HoldSolver solver;
    double before = 0.0;
    for (int step = -10; step <= 40; ++step) {
      problem.target = push * (5e-5 * step);
      const HoldMove move = solved(solver, problem, planes);
      REQUIRE(solver.converged());
      const double force = problem.stiffness * glm::dot(problem.target - move.translation, push);
      if (step > -10) CHECK(force >= before - 2.0 * kAllowedForce);  // two answers, each within its tolerance
      before = force;
    }
    loaded += before > 0.1;
  }
  CHECK(loaded >= 40);
}

TEST_CASE("hold solver: sets beyond its bounds do no harm") {
  const auto harmless = [](const HoldSolver& solver, const HoldMove& move) {
    CHECK(is_finite(move.translation));
    CHECK(is_finite(move.turn));
    CHECK(is_finite(move.engagement));
    CHECK(solver.rounds() <= kMaxHoldRounds);
    CHECK(solver.planes().size() <= kMaxHoldPlanes);
    for (const HoldPlane& plane : solver.planes()) CHECK((plane.force >= 0.0 && std::isfinite(plane.force)));
  };
  SUBCASE("a source that always finds another plane") {
    class Endless final : public HoldCandidates {
     public:
      std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                             std::span<const HoldPlane>) noexcept override {
        const Vec3 normal(uniform11(3, 3 * next_), uniform11(3, 3 * next_ + 1), uniform11(3, 3 * next_ + 2));
        const auto point = static_cast<std::uint32_t>(next_++);
        HoldPlane plane{glm::normalize(normal), 0.01 * normal, 0.0, 1e-7, next_ % 2 == 0, point, 0.0};
        plane.gap = -static_cast<double>(next_ * next_) - gap_of(problem, plane, move);  // wherever the tool went, deeper than all before
        return plane;
      }

     private:
      std::uint64_t next_ = 0;
    } endless;
    HoldSolver solver;
    const HoldMove move = solver.solve(pushed_down(), endless);
    CHECK_FALSE(solver.converged());
    CHECK(solver.rounds() == kMaxHoldRounds);
    CHECK(solver.planes().size() > 9);  // more than the unknowns do carry load, where bone yields
    harmless(solver, move);
  }
  SUBCASE("more planes than it keeps, shut in from all sides") {
    std::vector<HoldPlane> planes = random_planes(1, 500);
    for (HoldPlane& plane : planes) {
      if (plane.point % 2 == 0) plane.normal = -plane.normal;
      plane.gap = -1e-3;
    }
    HoldSolver solver;
    harmless(solver, solved(solver, pushed_down(), planes));
  }
  SUBCASE("planes alike that do not yield share the load, and none is tried again and again") {
    // Tilted by 1e-9: each is broken by 1e-12 m where another is met, and the two together would ask for forces of 1e6 N.
    std::vector<HoldPlane> planes;
    for (std::uint32_t n = 0; n < 50; ++n)
      planes.push_back({.normal = Vec3(1e-9 * std::cos(n), 1e-9 * std::sin(n), 1.0), .yield = 1e-30, .point = n});
    HoldProblem problem = pushed_down();
    problem.target.x = 1e-3;
    problem.tolerance = 1e-18;
    HoldSolver solver;
    solved(solver, problem, {planes[0]});  // not the one that is broken most
    harmless(solver, solved(solver, problem, planes));
    CHECK(solver.converged());
    CHECK(solver.planes().size() <= 2);  // of equal planes two may share the load
    CHECK(solver.rounds() <= 2);
    double force = 0.0;
    for (const HoldPlane& plane : solver.planes()) force += plane.force;
    // 5 kN/m over 2 mm; half a last digit of 2 mm, 2.2e-19 m, over the least yield, 2e-13 m/N, is 1.1e-6 N for each of two planes.
    CHECK(std::abs(force - 10.0) <= 2.2e-6);
  }
}

TEST_CASE("hold solver: of a level face of 300 points as many carry load as fit, evenly over the face") {
  std::vector<HoldPlane> planes;
  for (std::uint32_t n = 0; n < 300; ++n) {
    const double radius = 1e-3 * std::sqrt((n + 0.5) / 300.0), angle = 2.399963 * n;  // a sunflower: even over the disc
    planes.push_back({.arm = radius * Vec3(std::cos(angle), std::sin(angle), 0.0), .yield = 5e-8, .point = n});
  }
  HoldProblem problem = pushed_down();
  problem.tolerance = kTightTolerance;
  HoldSolver solver;
  const HoldMove move = solved(solver, problem, planes);
  CHECK(solver.converged());
  CHECK(solver.planes().size() == kMaxHoldPlanes);
  double force = 0.0, deepest = 0.0;
  for (const HoldPlane& plane : solver.planes()) {
    force += plane.force;
    deepest = std::max(deepest, plane.yield * plane.force);
  }
  // The whole face is as deep as those that carry load: it is level, and none of it would carry more than they do.
  for (const HoldPlane& plane : planes) CHECK(std::abs(gap_of(problem, plane, move)) <= deepest);
  CHECK(deepest < 2.0 * 5e-8 * force / static_cast<double>(kMaxHoldPlanes));
  // Springs in series; the yields side by side are at most that of one plane.
  CHECK(std::abs(force / (2e-3 * 5e3) - 1.0) <= 5e-8 * 5e3);
  (void)solved(solver, problem, planes);
  CHECK(solver.rounds() == 0);  // and no plane is searched again
}

namespace {

/// A level floor of 300 places, which takes all room of the solver with 0.3 N and more a place, and two walls, of the points 300 and 301, whose
/// normals are 0.2 to 0.4 rad to each side of -x.
std::vector<HoldPlane> floor_and_walls(std::uint64_t seed) {
  std::vector<HoldPlane> planes;
  for (std::uint32_t k = 0; k < 300; ++k) {
    const double radius = 5e-3 * std::sqrt((k + 0.5) / 300.0), angle = 2.399963 * k;
    planes.push_back({.arm = radius * Vec3(std::cos(angle), std::sin(angle), 0.0), .yield = 1.4e-7, .point = k});
  }
  for (const double side : {-1.0, 1.0}) {
    const double angle = side * (0.3 + 0.1 * uniform11(seed, static_cast<std::uint64_t>(side + 1.0)));
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    planes.push_back({.normal = -out, .arm = 5e-3 * out, .yield = 1.4e-7, .point = static_cast<std::uint32_t>(planes.size())});
  }
  return planes;
}

/// Fills the solver with the floor under 28 N. @returns the problem in which the hand is `aside` [m] besides.
HoldProblem pushed_aside(double aside, const std::vector<HoldPlane>& planes, HoldSolver& solver) {
  HoldProblem problem = pushed_down();
  problem.target = Vec3(0.0, 0.0, -5.6e-3);
  problem.tolerance = 1e-9;
  (void)solved(solver, problem, planes);
  REQUIRE(solver.planes().size() == kMaxHoldPlanes);
  problem.target.x = aside;
  return problem;
}

}  // namespace

TEST_CASE("hold solver: two places of a wall do not take turns for the last room beside a loaded floor") {
  // Two light walls are to hold the tool aside, with 0.16 N each: with one of them alone it slides along that one by 1e-5 m, far more than the
  // floor gives way.
  for (std::uint64_t n = 0; n < 40; ++n) {
    CAPTURE(n);
    const std::vector<HoldPlane> planes = floor_and_walls(n);
    HoldSolver solver;
    const HoldProblem problem = pushed_aside(6e-5, planes, solver);
    const HoldMove move = solved(solver, problem, planes);
    CHECK(solver.converged());
    CHECK(solver.rounds() == 2);
    // The walls give way by their yields alone: 1.4e-7 m/N under 0.3 N over the cosine of 0.4 squared, and what their tilt adds to it.
    CHECK(glm::length(Vec3(move.translation.x, move.translation.y, 0.0)) < 1e-7);
    const auto wall = [&](std::uint32_t k) { return force_of(solver, k) * planes[k].normal; };
    const Vec3 held = wall(300) + wall(301);
    CHECK(std::abs(held.x + problem.stiffness * problem.target.x) < problem.stiffness * 1e-7);
    CHECK(std::abs(held.y) < problem.stiffness * 1e-7);
  }
}

TEST_CASE(
    "hold solver: a place that would raise the energy by less than the one that it replaces lowers it stays out, and the answer is that of "
    "before") {
  // 0.3 um into the walls is more than the deepest place of the floor, 0.06 um. To hold the tool there would raise the energy by at most 5 kN/m over
  // 0.3 um, 2e-10 J; a place of the floor holds at least 0.3^2 x 1.4e-7 / 2 = 6e-9 J.
  for (std::uint64_t n = 0; n < 40; ++n) {
    CAPTURE(n);
    const std::vector<HoldPlane> planes = floor_and_walls(n);
    HoldSolver solver;
    const HoldProblem problem = pushed_aside(3e-7, planes, solver);
    const HoldMove move = solved(solver, problem, planes);
    CHECK_FALSE(solver.converged());
    CHECK(solver.rounds() == 0);  // ended in the first
    CHECK(solver.planes().size() == kMaxHoldPlanes);
    CHECK(force_of(solver, 300) == 0.0);
    CHECK(force_of(solver, 301) == 0.0);
    CHECK(std::abs(move.translation.x / problem.target.x - 1.0) < 1e-6);  // nothing holds it aside
    double force = 0.0;
    for (const HoldPlane& plane : solver.planes()) force += plane.force;
    CHECK(force == doctest::Approx(28.0).epsilon(1e-3));
  }
}
