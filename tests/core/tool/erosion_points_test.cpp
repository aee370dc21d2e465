#include "core/tool/erosion_points.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tests/core/tool/tool_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

ErosionPoints points_of(const ToolSpec& spec, double pitch) {
  auto points = make_erosion_points(spec, pitch);
  REQUIRE(points.ok());
  REQUIRE(points.value().positions.size() == points.value().factors.size());
  return std::move(points).value();
}

double volume_of(const ErosionPoints& points) { return static_cast<double>(points.size()) * points.pitch * points.pitch * points.pitch; }

ToolSpec single(const Solid& solid) { return tool_of({region(solid, 0.1, 1e-3)}); }

}  // namespace

TEST_CASE("erosion points: their volume converges to the closed form") {
  // heights and radii that are no multiple of a pitch; the flat ends of a stack then cost up to half a layer each
  for (const Solid& solid : {make_sphere(0.0, 2.03e-3), make_cone(0.0, 4.07e-3, 2.01e-3), make_ellipsoid(0.0, 6.1e-3, 2.3e-3),
                             make_frustum({.z_low = 0.0, .height = 3.11e-3, .low_radius = 3.1e-3, .high_radius = 1.2e-3}),
                             make_tube({.z_low = 0.0, .height = 4.07e-3, .low_radius = 3.03e-3, .high_radius = 2.6e-3}, {1.01e-3, 1.3e-3}),
                             make_box({.height = 4.03e-3, .size = {5.03e-3, 3.07e-3}, .centre = {0.71e-3, -0.33e-3}})}) {
    for (const double pitch : {0.4e-3, 0.2e-3, 0.1e-3}) {
      CAPTURE(pitch);
      const double error = std::abs(volume_of(points_of(single(solid), pitch)) - solid.volume());
      // only cells cut by the surface can be wrong, by at most their half volume each way; nearly all of it cancels but whole flat layers
      CHECK(error < 0.5 * solid.area() * pitch);
    }
    // at 0.1 mm a flat end of at most 3.1 mm radius may be off by half a layer: 0.05 * 30 / 45 mm3 = 3.4 %
    CHECK(volume_of(points_of(single(solid), 0.1e-3)) == doctest::Approx(solid.volume()).epsilon(0.035));
    CHECK(volume_of(points_of(single(solid), 0.04e-3)) == doctest::Approx(solid.volume()).epsilon(0.014));
  }
}

TEST_CASE("erosion points: a cylinder of whole layers has the area of its disc to the lattice's own error") {
  const double volume = volume_of(points_of(single(make_cylinder(0.0, 3e-3, 5.5e-3)), 0.1e-3));
  // the circle problem: a disc of radius 55 cells is off by a few times sqrt(55) of its 9503 cells
  CHECK(volume == doctest::Approx(kPi * 5.5e-3 * 5.5e-3 * 3e-3).epsilon(0.003));
}

TEST_CASE("erosion points: each is inside the tool and each lattice cell whose centre is inside has one") {
  const double pitch = 0.5e-3;
  const ToolSpec aside =
      tool_of({region(make_cylinder(0.0, 4e-3, 2e-3), 0.1, 1e-3),
               region(make_box({.z_low = 1e-3, .height = 2e-3, .size = {5e-3, 1.3e-3}, .centre = {4e-3, 0.2e-3}}), 0.1, 1e-3)});
  const ToolSpec crown = tool_of({region(make_tube({.height = 6e-3, .low_radius = 6e-3, .high_radius = 7e-3}, {4e-3, 5e-3}), 0.1, 1e-3)});
  for (const ToolSpec& spec : {perforator(1e-3), aside, crown}) {
    const ErosionPoints points = points_of(spec, pitch);
    std::size_t count = 0;  // slow twin: ask the solids for every cell of a generous box
    for (int k = -4; k < 40; ++k)
      for (int j = -20; j < 20; ++j)
        for (int i = -20; i < 20; ++i) {
          const Vec3 p((i + 0.5) * pitch, (j + 0.5) * pitch, (k + 0.5) * pitch);
          if (!inside_any(spec, p)) continue;
          REQUIRE(count < points.size());
          CHECK(points.positions[count] == p);  // and in the order k, j, i
          ++count;
        }
    CHECK(count == points.size());
  }
}

TEST_CASE("erosion points: mirror symmetric in x and in y, factors too") {
  const ErosionPoints points = points_of(burr(1e-3), 0.25e-3);
  using Row = std::tuple<double, double, double, float>;
  const auto rows = [&](double mx, double my) {
    std::vector<Row> all;
    for (std::size_t i = 0; i < points.size(); ++i)
      all.emplace_back(mx * points.positions[i].x, my * points.positions[i].y, points.positions[i].z, points.factors[i]);
    std::sort(all.begin(), all.end());
    return all;
  };
  CHECK(rows(-1.0, 1.0) == rows(1.0, 1.0));
  CHECK(rows(1.0, -1.0) == rows(1.0, 1.0));
}

TEST_CASE("erosion points: the two drills of a perforator keep their own factors") {
  const ErosionPoints points = points_of(perforator(1e-3), 0.5e-3);
  REQUIRE(std::ranges::count(points.factors, 0.028f) > 0);
  REQUIRE(std::ranges::count(points.factors, 0.14f) > 0);
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(points.factors[i] == (points.positions[i].z < 3e-3 ? 0.028f : 0.14f));
}

TEST_CASE("erosion points: passive regions have none, and the region listed first owns an overlap") {
  const ErosionPoints head = points_of(burr(1e-3), 0.1e-3);
  // A ball of 2 mm on cells of 0.1 mm: within the cells that its surface cuts, 4 pi r^2 of them and as many again for slanted ones.
  CHECK(std::abs(static_cast<double>(head.size()) - 33510.0) < 2.0 * 5027.0);
  for (const Vec3& p : head.positions) CHECK(glm::length(p - Vec3(0.0, 0.0, 2e-3)) <= 2e-3 + 1e-12);
  ToolSpec swapped = burr(1e-3);
  std::swap(swapped.regions[0], swapped.regions[1]);
  const ErosionPoints bored = points_of(swapped, 0.1e-3);
  CHECK(bored.size() > 0);
  CHECK(bored.size() < head.size());
  for (const Vec3& p : bored.positions) CHECK((p.z < 2.4e-3 || std::hypot(p.x, p.y) > 0.9e-3));
}

TEST_CASE("erosion law: constant in a core round the axis, then linear in the distance from it") {
  ToolSpec spec = single(make_cylinder(0.0, 4e-3, 2e-3));
  spec.regions[0].erosion.axis = 0.2;
  spec.regions[0].erosion.rim = 1.2;
  CHECK(erosion_factor_at(spec, {0.0, 0.0, 1e-3}) == doctest::Approx(0.1 * 0.2).epsilon(1e-12));
  CHECK(erosion_factor_at(spec, {0.0, 0.24e-3, 1e-3}) == doctest::Approx(0.1 * 0.2).epsilon(1e-12));
  // half way from the core of 0.25 mm to the rim at 2 mm
  CHECK(erosion_factor_at(spec, {1.125e-3, 0.0, 1e-3}) == doctest::Approx(0.1 * 0.7).epsilon(1e-12));
  CHECK(erosion_factor_at(spec, {0.0, -2e-3, 1e-3}) == doctest::Approx(0.1 * 1.2).epsilon(1e-12));
  CHECK(erosion_factor_at(spec, {0.0, 2.1e-3, 1e-3}) == 0.0);
  spec.regions[0].erosion.core = 0.0;
  CHECK(erosion_factor_at(spec, {1e-3, 0.0, 1e-3}) == doctest::Approx(0.1 * 0.7).epsilon(1e-12));
  spec.regions[0].erosion.core = 2e-3;  // as wide as the region
  CHECK(erosion_factor_at(spec, {1.9e-3, 0.0, 1e-3}) == doctest::Approx(0.1 * 0.2).epsilon(1e-12));
}

TEST_CASE("erosion law: by face within the skin, by interior_factor below it") {
  ToolSpec spec = perforator(1e-3);
  for (RegionSpec& one : spec.regions) {
    one.erosion.base = 1.0;
    one.erosion.skin = 0.4e-3;
    one.erosion.bottom = 2.0;
    one.erosion.side = 0.5;
    one.erosion.top = 0.0;
    one.erosion.interior = 3.0;
  }
  CHECK(erosion_factor_at(spec, {1e-3, 0.0, 0.1e-3}) == 2.0);    // flat bottom
  CHECK(erosion_factor_at(spec, {6.5e-3, 0.0, 3.1e-3}) == 2.0);  // ledge of the outer drill
  CHECK(erosion_factor_at(spec, {1e-3, 0.0, 3.1e-3}) == 3.0);    // where the drills meet: no surface, so interior
  CHECK(erosion_factor_at(spec, {0.0, 5.4e-3, 1.5e-3}) == 0.5);  // wall of the inner drill
  CHECK(erosion_factor_at(spec, {0.0, 6.9e-3, 6e-3}) == 0.5);
  CHECK(erosion_factor_at(spec, {0.0, 0.0, 6e-3}) == 3.0);
  CHECK(erosion_factor_at(spec, {0.0, 0.0, 11.9e-3}) == 0.0);
  for (const Vec3& p : points_of(spec, 0.25e-3).positions) CHECK((p.z < 11.6e-3 || std::hypot(p.x, p.y) > 6.6e-3));  // none under the top
}

TEST_CASE("erosion points: bad pitches and too many points are out of range, at once") {
  const ToolSpec spec = perforator(1e-3);
  for (const double pitch : {0.0, -1e-3, std::nan(""), HUGE_VAL, 1e-9, 1e-15, 3e-5}) {
    const auto points = make_erosion_points(spec, pitch);
    REQUIRE_FALSE(points.ok());
    CHECK(points.error().code == ErrorCode::out_of_range);
  }
  CHECK(make_erosion_points(spec, 3e-5).error().message ==
        "an erosion pitch of 0.03 mm makes more than 20000000 erosion points: take a coarser pitch");
}

TEST_CASE("erosion points: a pitch wider than the bit leaves no point rather than a wrong one") {
  CHECK(points_of(single(make_sphere(0.0, 1e-3)), 3e-3).size() == 0);
}

TEST_CASE("erosion law: each face of a box and the wall of a bore have their own factor") {
  ToolSpec box = single(make_box({.height = 4e-3, .size = {4e-3, 4e-3}}));
  ErosionRule& law = box.regions[0].erosion;
  law = {.base = 1.0, .bottom = 1.0, .side = 9.0, .top = 2.0, .flanks = {3.0, 4.0, 5.0, 6.0}, .interior = 7.0, .skin = 0.5e-3};
  const Vec3 middle(0.0, 0.0, 2e-3);
  CHECK(erosion_factor_at(box, middle) == 7.0);
  const std::pair<Vec3, double> faces[] = {{{0, 0, -1}, 1.0}, {{0, 0, 1}, 2.0},  {{-1, 0, 0}, 3.0},
                                           {{1, 0, 0}, 4.0},  {{0, -1, 0}, 5.0}, {{0, 1, 0}, 6.0}};
  for (const auto& [direction, factor] : faces) CHECK(erosion_factor_at(box, middle + 1.6e-3 * direction) == factor);
  ToolSpec tube = single(make_tube({.height = 4e-3, .low_radius = 4e-3, .high_radius = 4e-3}, {2e-3, 2e-3}));
  tube.regions[0].erosion = {.base = 1.0, .side = 3.0, .inner = 2.0, .interior = 7.0, .skin = 0.5e-3};
  CHECK(erosion_factor_at(tube, {2.4e-3, 0.0, 2e-3}) == 2.0);
  CHECK(erosion_factor_at(tube, {3.6e-3, 0.0, 2e-3}) == 3.0);
  CHECK(erosion_factor_at(tube, {3.0e-3, 0.0, 2e-3}) == 7.0);
  CHECK(erosion_factor_at(tube, {1.9e-3, 0.0, 2e-3}) == 0.0);
}

TEST_CASE("erosion points: a saw cuts with its teeth, flats left out, and with nothing else") {
  const ErosionPoints points = points_of(saw(0.5e-3), 0.05e-3);
  for (const Vec3& p : points.positions) {
    CHECK(p.z < 1.5e-3);
    CHECK(std::abs(p.y) < 0.28e-3 + 0.02e-3);  // the lowest layer reaches the edge of the kerf
  }
  // 12 x 0.6 x 1.5 mm; the top has no face where the blade stands on it, 0.02 mm of the flats are under one cell
  CHECK(volume_of(points) == doctest::Approx(12e-3 * 0.6e-3 * 1.5e-3).epsilon(0.1));
}
