// Contact as planes for the servo: at the pose it was found at it gives the model's own force, and its gradient is the slope of that force.
#include "core/contact/local_contact.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

Vec3 direction(std::uint64_t seed, std::uint64_t n) {
  const Vec3 v(uniform01(seed, 3 * n) - 0.5, uniform01(seed, 3 * n + 1) - 0.5, uniform01(seed, 3 * n + 2) - 0.5);
  return glm::normalize(v);
}

std::vector<Contact> contacts(std::size_t count, std::uint64_t seed) {
  std::vector<Contact> out(count);
  for (std::size_t n = 0; n < count; ++n) {
    out[n].point = static_cast<std::uint32_t>(n);
    out[n].normal = direction(seed, n);
    out[n].depth = 1e-4 * uniform01(seed, 100000 + n);
    out[n].position = 2e-3 * direction(seed + 1, n);
  }
  return out;
}

Vec3 sum_of(const std::vector<Contact>& contacts, double stiffness) {
  Vec3 sum(0.0);
  for (const Contact& c : contacts) sum += c.normal * (c.depth * stiffness);
  return sum;
}

Vec3 penalty_force(const LocalContact& local, const Vec3& moved) {
  Vec3 sum(0.0);
  for (const HoldPlane& plane : local.list())
    sum += plane.normal * (std::max(0.0, -(plane.gap + glm::dot(plane.normal, moved))) / plane.yield);
  return sum;
}

/// No planes but those listed.
class Listed final : public HoldCandidates {
 public:
  std::optional<HoldPlane> most_violated(const HoldProblem&, const HoldMove&, std::span<const HoldPlane>) noexcept override { return {}; }
};

/// Force on the hand of a tool held by the planes of `local`, the hand at `hand` from the tool.
Vec3 coupled_force(const LocalContact& local, const Vec3& hand) {
  HoldSolver solver;
  for (const HoldPlane& plane : local.list()) solver.add(plane);
  Listed none;
  const HoldMove move = solver.solve({.target = hand,
                                      .engaged = local.engaged,
                                      .stiffness = local.coupling_stiffness,
                                      .turn_stiffness = local.turn_stiffness,
                                      .cutting_stiffness = local.cutting_stiffness,
                                      .tolerance = 1e-12},
                                     none);
  return local.coupling_stiffness * (move.translation - hand);
}

}  // namespace

TEST_CASE("list_penalty: up to as many contacts as there is room for are listed as they are") {
  const auto found = contacts(32, 3);
  LocalContact local;
  list_penalty(found, Vec3(0.0), 500.0, local);
  REQUIRE(local.count == found.size());
  CHECK(local.kind == LocalKind::penalty);
  const Vec3 moved(2e-5, -1e-5, 3e-5);
  Vec3 expected(0.0);
  for (const Contact& c : found) expected += c.normal * (500.0 * std::max(0.0, c.depth - glm::dot(c.normal, moved)));
  CHECK(glm::length(penalty_force(local, moved) - expected) < 1e-12);
}

TEST_CASE("list_penalty: more contacts are merged, and the force at the pose stays to rounding, the trace of the gradient too") {
  for (const std::size_t count : {33, 500, 5800}) {
    const auto found = contacts(count, count);
    LocalContact local;
    list_penalty(found, Vec3(0.0), 2000.0 / static_cast<double>(count), local);
    CHECK(local.count <= kMaxLocalPlanes);
    const Vec3 expected = sum_of(found, 2000.0 / static_cast<double>(count));
    CHECK(glm::length(penalty_force(local, Vec3(0.0)) - expected) < 1e-12);
    const Mat3 g = force_gradient(local);
    CHECK(g[0][0] + g[1][1] + g[2][2] == doctest::Approx(-2000.0));
  }
}

TEST_CASE("force_gradient: penalty contacts, against central differences of the force") {
  const auto found = contacts(12, 9);
  LocalContact local;
  list_penalty(found, Vec3(0.0), 700.0, local);
  const Mat3 g = force_gradient(local);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 step(0.0);
    step[axis] = 1e-9;
    const Vec3 slope = (penalty_force(local, step) - penalty_force(local, -step)) / 2e-9;
    CHECK(glm::length(slope - g[axis]) < 1e-3);  // of 2800 N/m; a plane that opens within the step would show
  }
}

TEST_CASE("force_gradient: a coupled tool, against central differences of the solver's force, cutting and turning included") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    LocalContact local;
    local.kind = LocalKind::coupled;
    local.coupling_stiffness = 5000.0;
    local.turn_stiffness = 20.0;
    local.cutting_stiffness = 1e5;
    local.count = 1 + static_cast<std::uint32_t>(seed % 5);
    for (std::uint32_t n = 0; n < local.count; ++n) {
      HoldPlane& plane = local.planes[n];
      plane.normal = glm::normalize(Vec3(0.0, 0.0, 1.5) + direction(seed, n));
      plane.arm = 4e-3 * direction(seed + 50, n);
      plane.yield = 1e-6;
      plane.cutting = n % 2 == 0;
      plane.point = n;
    }
    const Vec3 hand(1e-4, -2e-4, -3e-3);
    // Which planes carry load is the solver's to say.
    HoldSolver solver;
    for (const HoldPlane& plane : local.list()) solver.add(plane);
    Listed none;
    (void)solver.solve({.target = hand, .stiffness = 5000.0, .turn_stiffness = 20.0, .cutting_stiffness = 1e5, .tolerance = 1e-12}, none);
    local.count = 0;
    for (const HoldPlane& plane : solver.planes()) local.planes[local.count++] = plane;
    const Mat3 g = force_gradient(local);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 step(0.0);
      step[axis] = 1e-8;
      const Vec3 slope = (coupled_force(local, hand + step) - coupled_force(local, hand - step)) / 2e-8;
      CHECK(glm::length(slope - g[axis]) < 1e-2);  // [N/m]: rounding of 20 N over a step of 2e-8 m is 1e-6
    }
    // Sabotage: without the turn the same planes are stiffer wherever they have an arm.
    LocalContact stiff = local;
    stiff.turn_stiffness = std::numeric_limits<double>::infinity();
    CHECK(std::abs(force_gradient(stiff)[2][2] - g[2][2]) > 1e-1);
  }
}
