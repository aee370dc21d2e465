// Cutting points of an engaged tool against the shape that its hole has, and rounded edges against the opening of simple solids.
#include "core/contact/lens_shell.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/contact/rounded_edges.h"

using namespace burrhole;

namespace {

constexpr double kEdge = 0.25e-3, kRadius = 1e-3;

/// A ball of cutting points, its middle at the origin.
PointShell ball_points() {
  PointShell shell;
  for (int n = 0; n < 400; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / 400.0, turn = n * std::numbers::pi * (3.0 - std::sqrt(5.0)), r = std::sqrt(1.0 - z * z);
    const Vec3 out(r * std::cos(turn), r * std::sin(turn), z);
    shell.positions.push_back(kRadius * out);
    shell.inward_normals.push_back(-out);
    shell.cutting.push_back(1);
  }
  return shell;
}

std::shared_ptr<const CuttingField> ball_field() {
  auto field = make_cutting_field(
      {Vec3(-kRadius), Vec3(kRadius)}, [](const Vec3& p) { return glm::length(p) - kRadius; }, [](const Vec3&) { return 0.1; },
      cutting_field_size(kEdge, kRadius));
  REQUIRE(field.ok());
  return std::make_shared<const CuttingField>(std::move(field).value());
}

/// A flat end of 2 mm, its bottom at z = 0, with points on bottom and side, `pitch` [m] apart.
PointShell cylinder_points(double radius, double height, double pitch) {
  PointShell shell;
  const auto add = [&](const Vec3& p, const Vec3& inward) {
    shell.positions.push_back(p);
    shell.inward_normals.push_back(inward);
    shell.cutting.push_back(1);
  };
  for (double r = 0.0; r < radius + 1e-9; r += pitch)
    for (int n = 0; n < 24; ++n) {
      const double turn = 2.0 * std::numbers::pi * n / 24.0;
      add({r * std::cos(turn), r * std::sin(turn), 0.0}, {0.0, 0.0, 1.0});
    }
  for (double z = 0.0; z < height + 1e-9; z += pitch)
    for (int n = 0; n < 24; ++n) {
      const double turn = 2.0 * std::numbers::pi * n / 24.0;
      add({radius * std::cos(turn), radius * std::sin(turn), z}, {-std::cos(turn), -std::sin(turn), 0.0});
    }
  return shell;
}

}  // namespace

TEST_CASE("lens shell: no point of the engaged tool lies outside the hole that the tool leaves") {
  const PointShell shell = ball_points();
  LensShell lens(shell, ball_field(), kEdge);
  for (const double engaged : {0.05e-3, 0.2e-3, 0.6e-3}) {
    lens.engage({0.0, 0.0, engaged});
    int moved = 0;
    for (std::size_t n = 0; n < shell.size(); ++n) {
      const Vec3 at = lens.at(n) + Vec3(0.0, 0.0, engaged);
      // The table is exact to 0.005 voxel, its gradient to a few degrees.
      CHECK(glm::length(at) < kRadius + 0.02 * kEdge);
      // The leading face stays: its points are deeper than the clearance inside the tool.
      if (shell.positions[n].z < -0.5 * kRadius) CHECK(lens.at(n) == shell.positions[n]);
      moved += lens.at(n) != shell.positions[n] ? 1 : 0;
    }
    CHECK(moved > 100);
  }
  // Sabotage: where nothing is moved, the sides of a deeply engaged ball are outside its hole.
  LensShell still(shell, nullptr, kEdge);
  still.engage({0.0, 0.0, 0.6e-3});
  double furthest = 0.0;
  for (std::size_t n = 0; n < shell.size(); ++n) furthest = std::max(furthest, glm::length(still.at(n) + Vec3(0.0, 0.0, 0.6e-3)));
  CHECK(furthest > kRadius + 0.5 * kEdge);
}

TEST_CASE("lens shell: without engagement the points are those of the tool") {
  const PointShell shell = ball_points();
  LensShell lens(shell, ball_field(), kEdge);
  lens.engage({0.0, 0.0, 0.3e-3});
  lens.engage(Vec3(0.0));
  for (std::size_t n = 0; n < shell.size(); ++n) CHECK(lens.at(n) == shell.positions[n]);
}

TEST_CASE("rounded edges: a flat end takes the radius at its rim and nowhere else") {
  const double radius = 2e-3, round = 0.4e-3;
  const PointShell shell = cylinder_points(radius, 3e-3, 0.1e-3);
  const std::vector<Vec3> moves = rounded_edges(shell, round);
  for (std::size_t n = 0; n < shell.size(); ++n) {
    const Vec3 at = shell.positions[n] + moves[n];
    const double across = std::hypot(at.x, at.y) - (radius - round), below = round - at.z;
    // 24 flat sides for a circle: the corner of their planes is 1 % of the radius further out.
    if (across > 0.0 && below > 0.0 && moves[n] != Vec3(0.0)) CHECK(std::hypot(across, below) == doctest::Approx(round).epsilon(0.03));
    const bool far_from_rim =
        std::hypot(shell.positions[n].x, shell.positions[n].y) < radius - 1.1 * round || shell.positions[n].z > 1.1 * round;
    if (far_from_rim && shell.positions[n].z < 3e-3 - 1.1 * round) CHECK(moves[n] == Vec3(0.0));
  }
  // The corner itself moves by sqrt(2) - 1 of the radius.
  double most = 0.0;
  for (const Vec3& move : moves) most = std::max(most, glm::length(move));
  CHECK(most == doctest::Approx((std::sqrt(2.0) - 1.0) * round).epsilon(0.05));
}

TEST_CASE("rounded edges: a ball has none, and a thin blade keeps its edge's place") {
  for (const Vec3& move : rounded_edges(ball_points(), 0.3e-3)) CHECK(move == Vec3(0.0));
  // 0.2 mm thick: the radius is at most 0.45 of it.
  PointShell blade;
  for (double x = 0.0; x < 2e-3; x += 0.1e-3)
    for (double z = 0.0; z < 2e-3; z += 0.1e-3)
      for (const double side : {0.0, 0.2e-3}) {
        blade.positions.push_back({x, side, z});
        blade.inward_normals.push_back({0.0, side == 0.0 ? 1.0 : -1.0, 0.0});
        blade.cutting.push_back(1);
      }
  for (const Vec3& move : rounded_edges(blade, 0.4e-3)) CHECK(glm::length(move) < 0.1e-3);
}
