#include "core/tool/outline.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

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
       {make_cylinder(0.0, 3e-3, 5.5e-3), make_cone(0.0, 4e-3, 2e-3), make_sphere(0.0, 2e-3), make_ellipsoid(0.0, 8e-3, 2e-3),
        make_tube({.z_low = 0.0, .height = 3e-3, .low_radius = 4e-3, .high_radius = 5e-3}, {1e-3, 5e-3})}) {
    const ToolSpec spec = tool_of({region(solid, 0.1, 1e-3)});
    const double area = outline_area(spec.outline, Face::bottom) + outline_area(spec.outline, Face::side) +
                        outline_area(spec.outline, Face::top) + outline_area(spec.outline, Face::inner);
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
  for (const ToolSpec& spec : {perforator(1e-3), burr(1e-3), odd_tool(), trephine(1e-3), ring(1e-3)})
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

TEST_CASE("outline: a crown's line comes down the bore and goes up the outer wall, one chain from the axis to the axis") {
  const ToolSpec spec = trephine(1e-3);
  REQUIRE(chains_of(spec.outline).size() == 1);
  CHECK(spec.outline.front().start == Meridian(0.0, 9e-3));  // under the cap
  CHECK(spec.outline.back().end == Meridian(0.0, 15e-3));
  const Face expected[] = {Face::bottom, Face::inner, Face::top,  Face::inner, Face::bottom, Face::side,
                           Face::top,    Face::side,  Face::side, Face::top,   Face::side,   Face::top};
  REQUIRE(spec.outline.size() == std::size(expected));
  for (std::size_t i = 0; i < spec.outline.size(); ++i) CHECK(spec.outline[i].face == expected[i]);
  for (std::size_t i = 1; i < spec.outline.size(); ++i) CHECK(spec.outline[i].start == spec.outline[i - 1].end);
}

TEST_CASE("outline: a tube alone is a ring that closes on itself; a pin in a crown and a hollow give chains of their own") {
  const ToolSpec tube = ring(1e-3);
  REQUIRE(chains_of(tube.outline).size() == 1);
  CHECK(tube.outline.front().start == tube.outline.back().end);
  // a box closed by two plates has an outside and a hollow inside
  const Solid hollow[] = {make_cylinder(0.0, 1e-3, 4e-3),
                          make_tube({.z_low = 1e-3, .height = 3e-3, .low_radius = 4e-3, .high_radius = 4e-3}, {3e-3, 3e-3}),
                          make_cylinder(4e-3, 1e-3, 4e-3)};
  const auto outline = make_outline(hollow);
  REQUIRE(outline.ok());
  CHECK(chains_of(*outline).size() == 2);
  double area = 0.0;
  for (const Face face : {Face::bottom, Face::side, Face::top, Face::inner}) area += outline_area(*outline, face);
  CHECK(area == doctest::Approx(kPi * (2 * 16e-6 + 8e-3 * 5e-3 + 2 * 9e-6 + 6e-3 * 3e-3)).epsilon(1e-9));  // straight lines: rounding
}

TEST_CASE("outline: random unions have the surface that random shells of points find") {
  // Slow twin: the area of a union by points spread evenly over each solid's own surface, counted where no other solid covers them.
  const auto part = [](std::uint64_t seed, std::uint64_t i, double lo, double hi) { return lo + (hi - lo) * uniform01(seed, i); };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    std::vector<Solid> solids{make_cylinder(0.0, 20e-3, part(seed, 0, 0.5e-3, 1e-3))};
    for (std::uint64_t n = 1; n < 5; ++n) {
      const double z = part(seed, 10 * n, 0.0, 12e-3), h = part(seed, 10 * n + 1, 2e-3, 7e-3), r = part(seed, 10 * n + 2, 2e-3, 5e-3);
      const double top = part(seed, 10 * n + 3, 2e-3, 5e-3), bore = part(seed, 10 * n + 4, 0.1, 0.9) * std::min(r, top);
      const FrustumSize size{.z_low = z, .height = h, .low_radius = r, .high_radius = top};
      solids.push_back(n == 1 ? make_ellipsoid(z, h, r) : n == 2 ? make_frustum(size) : make_tube(size, {bore, bore}));
    }
    const auto outline = make_outline(solids);
    if (!outline) continue;  // a bored part may not touch the rest
    double area = 0.0, twin = 0.0;
    for (const Face face : {Face::bottom, Face::side, Face::top, Face::inner}) area += outline_area(*outline, face);
    for (std::size_t i = 0; i < solids.size(); ++i) {
      const std::vector<OutlinePiece> pieces = tool_of({region(solids[i], 0.1, 1e-3)}).outline;
      for (const OutlinePiece& piece : pieces)
        for (int k = 0; k < 4000; ++k) {
          const double f = (k + 0.5) / 4000;
          const Meridian at = piece.point(f), out = piece.outward(f);
          const bool covered = is_covered(solids, i, {at.x, 0.0, at.y}, {out.x, 0.0, out.y});
          twin += covered ? 0.0 : 2.0 * kPi * at.x * piece.length() / 4000;
        }
    }
    // each cut is found by the twin to one step in 4000 of an edge; a union has at most some twenty cuts on ten edges
    CHECK(area == doctest::Approx(twin).epsilon(2e-3));
  }
}

TEST_CASE("outline: boxes must hold to the rest: beside it or above it they do not") {
  const auto fault = [](const Solid& box) {
    const Solid solids[] = {make_cylinder(0.0, 4e-3, 2e-3), box};
    const auto outline = make_outline(solids);
    return outline ? std::string() : outline.error().message;
  };
  CHECK(fault(make_box({.z_low = 4e-3, .height = 1e-3, .size = {1e-3, 1e-3}})).empty());    // stands on it
  CHECK(fault(make_box({.z_low = 1e-3, .height = 1e-3, .size = {9e-3, 0.1e-3}})).empty());  // runs through it
  CHECK(fault(make_box({.z_low = 1e-3, .height = 1e-3, .size = {1e-3, 1e-3}, .centre = {2.4e-3, 0.0}})).empty());
  CHECK(fault(make_box({.z_low = 5e-3, .height = 1e-3, .size = {1e-3, 1e-3}})) == "regions do not hold together at z = 4 mm");
  CHECK(fault(make_box({.z_low = 1e-3, .height = 1e-3, .size = {1e-3, 1e-3}, .centre = {3e-3, 0.0}})) ==
        "regions do not hold together at z = 4 mm");
  const Solid edge[] = {make_box({.height = 1e-3, .size = {1e-3, 1e-3}}),
                        make_box({.z_low = 1e-3, .height = 1e-3, .size = {1e-3, 1e-3}, .centre = {1e-3, 0.0}})};
  CHECK_FALSE(make_outline(edge).ok());  // boxes that share an edge are two
}

TEST_CASE("signed distance: the closed form of a box and of a tube") {
  const Solid box = make_box({.height = 4e-3, .size = {6e-3, 2e-3}, .centre = {1e-3, 0.0}});
  const Solid tube = make_tube({.height = 4e-3, .low_radius = 3e-3, .high_radius = 3e-3}, {1e-3, 1e-3});
  const ToolSpec box_spec = tool_of({region(box, 0.1, 1e-3)}), tube_spec = tool_of({region(tube, 0.1, 1e-3)});
  const auto rounded = [](const Vec3& q) {  // distance to a box by how far each coordinate is beyond its half
    return std::min(std::max({q.x, q.y, q.z}), 0.0) + glm::length(glm::max(q, Vec3(0.0)));
  };
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vec3 p = random_point(19, i, Vec3(-6e-3, -5e-3, -2e-3), Vec3(6e-3, 5e-3, 6e-3));
    const Vec3 q = glm::abs(p - Vec3(1e-3, 0.0, 2e-3)) - Vec3(3e-3, 1e-3, 2e-3);
    CHECK(std::abs(signed_distance(box_spec.solids(), box_spec.outline, p) - rounded(q)) < 1e-15);  // rounding
    const glm::dvec2 t(std::abs(std::hypot(p.x, p.y) - 2e-3) - 1e-3, std::abs(p.z - 2e-3) - 2e-3);
    const double expected = std::min(std::max(t.x, t.y), 0.0) + std::hypot(std::max(t.x, 0.0), std::max(t.y, 0.0));
    CHECK(std::abs(signed_distance(tube_spec.solids(), tube_spec.outline, p) - expected) < 1e-15);
  }
}

TEST_CASE("nearest face: a face that another region covers is none") {
  const ToolSpec spec = saw(0.5e-3);
  const auto face = [&](const Vec3& p) { return find_nearest_face(spec.solids(), spec.outline, p); };
  CHECK(face({1e-3, 0.0, 0.1e-3}).face == Face::bottom);
  CHECK(face({1e-3, 0.25e-3, 0.5e-3}).face == Face::plus_y);
  CHECK(face({5.9e-3, 0.0, 1.0e-3}).face == Face::plus_x);
  // where the blade stands on the teeth there is no surface: the flank is nearest, at 0.2 mm
  CHECK(face({0.0, 0.01e-3, 1.5001e-3}).distance == doctest::Approx(0.19e-3).epsilon(1e-9));
  // deep in the hub the blade's flanks are covered: the hub's own wall is nearest
  CHECK(face({0.0, 0.0, 10e-3}).solid == 2);
}
