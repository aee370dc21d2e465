#include "core/tool/outline.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/tool/tool_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A tool that has every kind of joint: cone tip, step out, crossing sphere, oblique shoulder, step in.
ToolSpec odd_tool() {
  return tool_of({region(make_cone(0.0, 1e-3, 1e-3), 0.1, 2e-4), region(make_sphere(0.5e-3, 2e-3), 0.1, 2e-4),
                  region(make_cylinder(3.5e-3, 2e-3, 1.5e-3), 0.0, 2e-4),
                  region(make_frustum({.z_low = 5.5e-3, .height = 1e-3, .low_radius = 2.5e-3, .high_radius = 1e-3}), 0.0, 2e-4),
                  region(make_cylinder(6.5e-3, 3e-3, 0.7e-3), 0.0, 2e-4)});
}

double outline_area(std::span<const OutlinePiece> outline, Face face) {
  double sum = 0.0;
  for (const OutlinePiece& piece : outline) {
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps && piece.face == face; ++i) {
      const Meridian a = piece.point(static_cast<double>(i) / kSteps), b = piece.point((i + 1.0) / kSteps);
      sum += kPi * (a.x + b.x) * glm::length(b - a);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("outline: it runs from the tip's pole to the shaft's without a gap") {
  for (const ToolSpec& spec : {perforator(1e-3), burr(1e-3), odd_tool()}) {
    CHECK(spec.outline.front().start == Meridian(0.0, 0.0));
    CHECK(spec.outline.back().end.x == 0.0);
    for (std::size_t i = 1; i < spec.outline.size(); ++i) CHECK(spec.outline[i].start == spec.outline[i - 1].end);
    for (const OutlinePiece& piece : spec.outline) {
      CHECK(piece.point(0.0) == piece.start);
      CHECK(piece.point(1.0) == piece.end);
    }
  }
}

TEST_CASE("outline: a stacked perforator has its five faces, each with the right owner") {
  const ToolSpec spec = perforator(1e-3);
  REQUIRE(spec.outline.size() == 5);
  const std::pair<std::size_t, Face> expected[] = {{0, Face::bottom}, {0, Face::side}, {1, Face::bottom}, {1, Face::side}, {1, Face::top}};
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(spec.outline[i].solid == expected[i].first);
    CHECK(spec.outline[i].face == expected[i].second);
  }
  CHECK(spec.outline[2].start == Meridian(5.5e-3, 3e-3));  // the ledge between the drills
  CHECK(spec.outline[2].end == Meridian(7e-3, 3e-3));
}

TEST_CASE("outline: a single solid has the closed-form area") {
  for (const Solid& solid :
       {make_cylinder(0.0, 3e-3, 5.5e-3), make_cone(0.0, 4e-3, 2e-3), make_sphere(0.0, 2e-3), make_ellipsoid(0.0, 8e-3, 2e-3)}) {
    const ToolSpec spec = tool_of({region(solid, 0.1, 1e-3)});
    const double area =
        outline_area(spec.outline, Face::bottom) + outline_area(spec.outline, Face::side) + outline_area(spec.outline, Face::top);
    // 2000 chords on half a turn are short by (pi / 2000)^2 / 24 = 1e-7
    CHECK(area == doctest::Approx(solid.area()).epsilon(1e-6));
  }
}

TEST_CASE("outline: a sphere's shank begins where sphere and cylinder cross") {
  const ToolSpec spec = burr(1e-3);
  REQUIRE(spec.outline.size() == 3);
  const double crossing = 2e-3 + std::sqrt(2e-3 * 2e-3 - 0.9e-3 * 0.9e-3);
  CHECK(spec.outline[0].end.y == doctest::Approx(crossing).epsilon(1e-12));  // a quadratic's root, a few rounding errors
  CHECK(spec.outline[1].face == Face::side);
  CHECK(spec.outline[1].solid == 1);
}

TEST_CASE("outline: stepping out along the normal leaves the tool, stepping in stays") {
  for (const ToolSpec& spec : {perforator(1e-3), burr(1e-3), odd_tool()})
    for (const OutlinePiece& piece : spec.outline)
      for (int i = 1; i < 50; ++i) {
        const Meridian at = piece.point(i / 50.0), out = 1e-7 * piece.outward(i / 50.0);  // 0.1 um: above rounding, below any detail
        CHECK(std::abs(glm::length(out) - 1e-7) < 1e-20);
        CHECK_FALSE(inside_any(spec, {at.x + out.x, 0.0, at.y + out.y}));
        CHECK(inside_any(spec, {at.x - out.x, 0.0, at.y - out.y}));
      }
}

TEST_CASE("signed distance: its sign is the inside test and it is the closed form of a sphere, a cylinder and a cone") {
  const auto distance = [](const ToolSpec& spec, const Vec3& p) { return signed_distance(spec.solids(), spec.outline, p); };
  const ToolSpec ball = tool_of({region(make_sphere(0.0, 2e-3), 0.1, 1e-3)});
  const ToolSpec tube = tool_of({region(make_cylinder(0.0, 4e-3, 2e-3), 0.1, 1e-3)});
  const ToolSpec cone = tool_of({region(make_cone(0.0, 3e-3, 4e-3), 0.1, 1e-3)});
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = random_point(9, static_cast<std::uint64_t>(i), Vec3(-5e-3, -5e-3, -3e-3), Vec3(5e-3, 5e-3, 7e-3));
    const double r = std::hypot(p.x, p.y);
    // chords of 1/128 turn lie up to R (pi / 256)^2 / 2 = 1.5e-7 m inside the sphere
    CHECK(std::abs(distance(ball, p) - (glm::length(p - Vec3(0.0, 0.0, 2e-3)) - 2e-3)) < 2e-7);
    const double dr = r - 2e-3, dz = std::abs(p.z - 2e-3) - 2e-3;
    const double expected = std::min(std::max(dr, dz), 0.0) + std::hypot(std::max(dr, 0.0), std::max(dz, 0.0));
    CHECK(std::abs(distance(tube, p) - expected) < 1e-15);  // rounding
    // inside a cone the nearest wall is its flank (3-4-5 triangle) or its base
    if (cone.regions[0].solid.contains(p)) CHECK(std::abs(distance(cone, p) + std::min((4.0 * p.z - 3.0 * r) / 5.0, 3e-3 - p.z)) < 1e-15);
  }
}

TEST_CASE("signed distance: a wall between stacked regions is no surface") {
  const ToolSpec spec = perforator(1e-3);
  // on the axis, in the plane where the drills meet, the nearest surface is the flat bottom 3 mm below
  CHECK(signed_distance(spec.solids(), spec.outline, {0.0, 0.0, 3e-3}) == doctest::Approx(-3e-3).epsilon(1e-12));
}

TEST_CASE("outline: regions that fall apart or touch in a point are refused with the height") {
  const Solid apart[] = {make_cylinder(0.0, 1e-3, 1e-3), make_cylinder(2e-3, 1e-3, 1e-3)};
  const auto gap = make_outline(apart);
  REQUIRE_FALSE(gap.ok());
  CHECK(gap.error().message == "regions do not hold together at z = 1 mm");
  const Solid touching[] = {make_sphere(0.0, 1e-3), make_sphere(2e-3, 1e-3)};
  const auto point = make_outline(touching);
  REQUIRE_FALSE(point.ok());
  CHECK(point.error().message == "regions do not hold together at z = 2 mm");
  CHECK_FALSE(make_outline({}).ok());
}
