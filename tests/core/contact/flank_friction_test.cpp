// flank_friction against closed forms: how stiff a flat end, a ball and a blade are held sideways, how that is let go, and where it slips.
#include "core/contact/flank_friction.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace burrhole;

namespace {

constexpr double kCut = 100e3;  ///< [N/m]
constexpr double kPi = std::numbers::pi;

/// Points with what they are felt at.
struct Felt {
  PointShell shell;
  ProbeHits hits;
  void add(const Vec3& place, const Vec3& inward, bool inside) {
    shell.positions.push_back(place);
    shell.inward_normals.push_back(inward);
    shell.cutting.push_back(1);
    hits.point.push_back(static_cast<std::uint32_t>(hits.count++));
    hits.distance.push_back(inside ? -0.5f : 0.5f);
  }
};

/// A flat end, its rim sharp, points `pitch` apart: face at z = 0, flank up to `height`; under the surface up to `depth`.
Felt flat_end(double radius, double depth, double height, double pitch) {
  Felt out;
  const int faces = static_cast<int>(kPi * radius * radius / (pitch * pitch));
  for (int n = 0; n < faces; ++n) {
    const double r = radius * std::sqrt((n + 0.5) / faces), turn = 2.399963229728653 * n;
    out.add({r * std::cos(turn), r * std::sin(turn), 0.0}, {0.0, 0.0, 1.0}, true);
  }
  const int round = static_cast<int>(2.0 * kPi * radius / pitch);
  for (double z = 0.5 * pitch; z < height; z += pitch)
    for (int n = 0; n < round; ++n) {
      const double c = std::cos(2.0 * kPi * n / round), s = std::sin(2.0 * kPi * n / round);
      out.add({radius * c, radius * s, z}, {-c, -s, 0.0}, z < depth);
    }
  return out;
}

/// A ball's end, even in area, touching up to `angle` from its lowest point.
Felt ball_end(double radius, double angle) {
  Felt out;
  constexpr int kPoints = 20000;  // of the half ball
  for (int n = 0; n < kPoints; ++n) {
    const double c = 1.0 - (n + 0.5) / kPoints, s = std::sqrt(1.0 - c * c), turn = 2.399963229728653 * n;
    const Vec3 outward(s * std::cos(turn), s * std::sin(turn), -c);
    out.add(radius * outward, -outward, std::acos(c) < angle);
  }
  return out;
}

FlankFriction gripped(const Felt& felt, const Vec3& engaged, const Pose& pose = {}) {
  FlankFriction grip;
  grip.look(felt.hits, felt.shell, pose, engaged, kCut);
  return grip;
}

double stiffness_of(const HoldPlane& plane) { return plane.yield > 0.0 ? 1.0 / plane.yield : 0.0; }

constexpr double kRadius = 5e-3, kDepth = 0.4e-3;
const Vec3 kEngaged(0.0, 0.0, kDepth);
Felt flat() { return flat_end(kRadius, kDepth, 1e-3, 0.1e-3); }
Pose shifted(const Vec3& by) { return {Quat(1.0, 0.0, 0.0, 0.0), by}; }

}  // namespace

TEST_CASE("flank friction: a flat end is held by K_cut d / (2 R) on all sides, whichever way it is turned") {
  for (const Quat& turn : {Quat(1.0, 0.0, 0.0, 0.0), glm::angleAxis(0.9, glm::normalize(Vec3(1.0, 2.0, 0.5)))}) {
    const FlankFriction grip = gripped(flat(), turn * kEngaged, {turn, Vec3(1e-3, 2e-3, 3e-3)});
    for (const HoldPlane& plane : grip.planes({turn, Vec3(1e-3, 2e-3, 3e-3)})) {
      CHECK(plane.both_ways);
      CHECK(plane.gap == 0.0);
      CHECK(std::abs(glm::dot(plane.normal, turn * Vec3(0.0, 0.0, 1.0))) < 1e-12);
      // Points of face and rim are whole numbers: 1 in 300 of the rim's.
      CHECK(stiffness_of(plane) == doctest::Approx(kCut * kDepth / (2.0 * kRadius)).epsilon(0.005));
    }
  }
  // Sabotage: by half the depth it is held half as much.
  const FlankFriction less = gripped(flat_end(kRadius, 0.5 * kDepth, 1e-3, 0.1e-3), 0.5 * kEngaged);
  CHECK(stiffness_of(less.planes({})[0]) < 0.55 * kCut * kDepth / (2.0 * kRadius));
}

TEST_CASE("flank friction: a ball is held by K_cut times the integral over its cap, and hardly at a touch") {
  for (const double angle : {0.1, 0.2, 0.5}) {
    CAPTURE(angle);
    const double c = std::cos(angle);
    // 1/2 of the integrals of sin^2/2 and cos^2 over the cap; t^2 / 8 to first order.
    const double expected = kCut * 0.25 * (2.0 / 3.0 - c + c * c * c / 3.0) / ((1.0 - c * c * c) / 3.0);
    CHECK(expected == doctest::Approx(kCut * angle * angle / 8.0).epsilon(angle * angle));
    const FlankFriction grip = gripped(ball_end(2e-3, angle), Vec3(0.0, 0.0, 2e-3 * (1.0 - c)));
    // 100 points and more in the least cap: its rim is off by one of them.
    for (const HoldPlane& plane : grip.planes({})) CHECK(stiffness_of(plane) == doctest::Approx(expected).epsilon(0.03));
  }
  CHECK(gripped(ball_end(2e-3, 0.005), Vec3(0.0, 0.0, 1e-5)).planes({})[0].yield == 0.0);  // the one lowest point has no flank
}

TEST_CASE("flank friction: a blade is held across and not along") {
  Felt blade;
  for (double x = -4e-3; x < 4e-3; x += 0.1e-3) {
    blade.add({x, 0.0, 0.0}, {0.0, 0.0, 1.0}, true);
    for (const double side : {-1.0, 1.0}) blade.add({x, side * 0.3e-3, 0.1e-3}, {0.0, -side, 0.0}, true);
  }
  const auto planes = gripped(blade, kEngaged).planes({});
  CHECK(std::abs(planes[0].normal.y) > 1.0 - 1e-12);
  CHECK(stiffness_of(planes[0]) == doctest::Approx(kCut));  // 2 flanks over 2 of one face
  CHECK(planes[1].yield == 0.0);
}

TEST_CASE("flank friction: cutting relaxes the lateral displacement by the cut share, and back and forth cuts nothing") {
  const Felt felt = flat();
  FlankFriction grip = gripped(felt, kEngaged);
  const Vec3 aside(20e-6, 0.0, 0.0);
  grip.settle(shifted(aside), kEngaged, 40.0);
  CHECK(glm::length(grip.aside() - aside) < 1e-12);  // nothing was cut
  Vec3 at = aside;
  const auto sink = [&](double by) {
    grip.look(felt.hits, felt.shell, shifted(at), kEngaged, kCut);
    at.z -= by;
    grip.settle(shifted(at), kEngaged, 40.0);
  };
  sink(0.25 * kDepth);
  CHECK(glm::length(grip.aside() - 0.75 * aside) < 1e-12);
  for (int n = 0; n < 10; ++n) {
    sink(-0.2 * kDepth);
    sink(0.2 * kDepth);
  }
  CHECK(glm::length(grip.aside() - 0.75 * aside) < 1e-12);
  // More thrust engages further and cuts nothing: the surface that is felt stays.
  grip.look(felt.hits, felt.shell, shifted(at), kEngaged, kCut);
  grip.settle(shifted(at - 0.1 * kEngaged), 1.1 * kEngaged, 44.0);
  CHECK(glm::length(grip.aside() - 0.75 * aside) < 1e-12);
  at -= 0.1 * kEngaged;
  sink(2.0 * kDepth);
  CHECK(glm::length(grip.aside()) < 1e-12);  // all of it is gone
}

TEST_CASE("flank friction: it slips at half the thrust, and where a ball has climbed out of its dent") {
  FlankFriction grip = gripped(flat(), kEngaged);
  grip.settle(shifted({1e-3, 0.0, 0.0}), kEngaged, 2.0);
  CHECK(kCut * kDepth / (2.0 * kRadius) * glm::length(grip.aside()) == doctest::Approx(1.0).epsilon(0.005));
  constexpr double kAngle = 0.2;
  FlankFriction ball = gripped(ball_end(2e-3, kAngle), Vec3(0.0, 0.0, 2e-3 * (1.0 - std::cos(kAngle))));
  ball.settle(shifted({1e-3, 0.0, 0.0}), Vec3(0.0, 0.0, 0.04e-3), 4.0);
  CHECK(glm::length(ball.aside()) == doctest::Approx(2e-3 * std::sin(kAngle)).epsilon(0.02));  // even load: 2 % less by cos^2
}

TEST_CASE("flank friction: a tool in air, or one that was cleared, is held by nothing") {
  Felt air = flat();
  for (float& distance : air.hits.distance) distance = 0.5f;
  FlankFriction grip = gripped(air, kEngaged);
  for (const HoldPlane& plane : grip.planes({})) CHECK(plane.yield == 0.0);
  grip = gripped(flat(), kEngaged);
  grip.settle(shifted({1e-5, 0.0, 0.0}), kEngaged, 40.0);
  grip.clear();
  CHECK(grip.aside() == Vec3(0.0));
  CHECK(grip.planes({})[0].yield == 0.0);
}

TEST_CASE("flank friction: a tool that goes further along the push in a period than it was engaged is held by nothing and starts anew") {
  const Vec3 engaged(0.0, 0.0, 0.2e-3);
  const Felt felt = flat_end(2e-3, 0.2e-3, 1e-3, 0.1e-3);
  for (const double way : {-0.19e-3, 0.19e-3, -0.21e-3, 0.21e-3}) {
    CAPTURE(way);
    FlankFriction grip = gripped(felt, engaged);
    const Pose there{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.05e-3, 0.0, way)};
    const bool held = std::abs(way) < 0.2e-3;
    CHECK((grip.planes(there)[0].yield > 0.0) == held);
    grip.settle(there, engaged, 20.0);
    CHECK((glm::length(grip.aside()) > 0.0) == held);
  }
}
