// Pictures of bits: closed, inside the solid that erodes, and sweeping all of it.
#include "core/tool/fluted_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "core/tool/tool_mesh.h"
#include "tests/core/tool/tool_samples.h"
#include "tests/support/shipped_spec.h"
#include "tests/support/source_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

Vec3 corner(const TriangleMesh& mesh, std::size_t n) { return Vec3(mesh.positions[mesh.indices[n]]); }

double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    sum += glm::dot(corner(mesh, t), glm::cross(corner(mesh, t + 1), corner(mesh, t + 2))) / 6.0;
  return sum;
}

/// Directed edges less those the other way round; 0 everywhere on a closed surface.
std::size_t open_edges(const TriangleMesh& mesh) {
  using Key = std::array<float, 3>;
  const auto key = [&](std::size_t n) {
    const Vec3f p = mesh.positions[mesh.indices[n]];
    return Key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 becomes 0
  };
  std::map<std::pair<Key, Key>, int> edges;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const Key a = key(t + i), b = key(t + (i + 1) % 3);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  return static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }));
}

/// @returns the ranges of x [m] with material on the line through (y, z), by the sides from which its triangles are crossed.
std::vector<std::pair<double, double>> material_along_x(const TriangleMesh& mesh, double y, double z) {
  std::vector<std::pair<double, int>> crossings;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vec3 a = corner(mesh, t), b = corner(mesh, t + 1), c = corner(mesh, t + 2);
    const auto area = [](const Vec3& p, const Vec3& q, double v, double w) { return (q.y - p.y) * (w - p.z) - (q.z - p.z) * (v - p.y); };
    const double whole = area(a, b, c.y, c.z);
    const double u = area(b, c, y, z) / whole, v = area(c, a, y, z) / whole, w = 1.0 - u - v;
    if (std::abs(whole) < 1e-16 || u < 0.0 || v < 0.0 || w < 0.0) continue;
    crossings.emplace_back(u * a.x + v * b.x + w * c.x, whole < 0.0 ? 1 : -1);
  }
  std::ranges::sort(crossings);
  std::vector<std::pair<double, double>> out;
  int depth = 0;
  double from = 0.0;
  for (const auto& [x, way] : crossings) {
    if (depth == 0) from = x;
    depth += way;
    if (depth == 0) out.emplace_back(from, x);
  }
  return out;
}

Meridian swept(const Vec3& p) { return {std::sqrt(p.x * p.x + p.y * p.y), p.z}; }

double distance_to_segment(const Meridian& p, const Meridian& a, const Meridian& b) {
  const Meridian along = b - a;
  const double square = glm::dot(along, along);
  const double share = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + share * along));
}

/// Largest distance [m] from a point of the solids' outline to what the mesh's edges sweep, taken as straight in the meridian plane.
double farthest_unswept(const ToolSpec& spec, const TriangleMesh& mesh) {
  double farthest = 0.0;
  for (const OutlinePiece& piece : spec.outline)
    for (const double fraction : {0.0, 0.13, 0.31, 0.5, 0.68, 0.87, 1.0}) {
      const Meridian at = piece.point(fraction);
      double nearest = 1.0;
      for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
        for (std::size_t i = 0; i < 3; ++i)
          nearest = std::min(nearest, distance_to_segment(at, swept(corner(mesh, t + i)), swept(corner(mesh, t + (i + 1) % 3))));
      farthest = std::max(farthest, nearest);
    }
  return farthest;
}

std::vector<ToolSpec> shipped_specs() {
  std::vector<ToolSpec> specs;
  for (const auto& entry : std::filesystem::directory_iterator(test::in_source("app/tools"))) {
    const auto document = TomlDocument::load(entry.path().string());
    REQUIRE(document.ok());
    Issues issues;
    auto spec = read_tool_spec(document.value(), issues);
    REQUIRE(spec);
    specs.push_back(std::move(*spec));
  }
  REQUIRE_FALSE(specs.empty());
  return specs;
}

}  // namespace

TEST_CASE("fluted mesh: every shipped bit is closed, lies within its solids and sweeps all of them within 0.1 mm") {
  for (const ToolSpec& filed : shipped_specs()) {
    CAPTURE(filed.name);
    const ToolSpec spec = as_drawn(filed);
    const TriangleMesh mesh = make_fluted_mesh(filed);
    CHECK(open_edges(mesh) == 0);
    REQUIRE(mesh.normals.size() == mesh.positions.size());
    const std::vector<Solid> solids = spec.solids();
    double outside = 0.0;
    for (const Vec3f& p : mesh.positions) outside = std::max(outside, signed_distance(solids, spec.outline, Vec3(p)));
    // Arcs of signed_distance are chords of 128 steps, 1e-4 of the radius inside; positions are floats.
    CHECK(outside < 2e-6);
    CHECK(farthest_unswept(spec, mesh) < 0.1e-3);
    // Sabotage: the same mesh, a quarter of a millimetre thinner.
    TriangleMesh thin = mesh;
    for (Vec3f& p : thin.positions) {
      const auto share = static_cast<float>(std::max(0.0, 1.0 - 0.25e-3 / std::max(1e-9, swept(Vec3(p)).x)));
      p *= Vec3f(share, share, 1.0f);
    }
    if (find_cutting_edges(spec).count > 0) CHECK(farthest_unswept(spec, thin) > 0.1e-3);
  }
}

TEST_CASE("fluted mesh: what cuts has flutes, what does not is as smooth as it was") {
  for (const ToolSpec& spec : shipped_specs()) {
    CAPTURE(spec.name);
    const CuttingEdges edges = find_cutting_edges(spec);
    const double smooth = volume(make_tool_mesh(as_drawn(spec), 128)), fluted = volume(make_fluted_mesh(spec));
    CHECK(fluted > 0.5 * smooth);
    if (edges.count > 0) CHECK(fluted < smooth);
    if (edges.count == 0) CHECK(fluted > 0.9 * smooth);  // a saw has gaps between its teeth
    if (edges.count == 0) CHECK(fluted < (1.0 + 1e-6) * smooth);
  }
  const ToolSpec ball = tool_of({region(make_sphere(0.0, 3e-3), 0.1, 1e-3)});
  CHECK(find_cutting_edges(ball).count == 12);
  const ToolSpec passive = tool_of({region(make_sphere(0.0, 3e-3), 0.0, 1e-3)});
  CHECK(find_cutting_edges(passive).count == 0);
  CHECK(volume(make_fluted_mesh(passive)) == volume(make_tool_mesh(passive)));
}

TEST_CASE("fluted mesh: only a twist drill is drawn wider than it is filed: its body has the proportions of a drill") {
  for (const ToolSpec& spec : shipped_specs()) {
    CAPTURE(spec.name);
    const ToolSpec drawn = as_drawn(spec);
    const bool drill = spec.name == "twist_drill_2_5mm";
    for (std::size_t n = 0; n < spec.regions.size(); ++n)
      CHECK((drawn.regions[n].solid.largest_radius() == spec.regions[n].solid.largest_radius()) == !(drill && n == 2));
  }
  // Sections of the body at two heights: from the web to the margins; the land between flutes turns by the helix.
  const TriangleMesh mesh = make_fluted_mesh(shipped_spec("twist_drill_2_5mm"));
  double least = 1.0, most = 0.0, area = 0.0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const auto at = [&](std::size_t n) { return Vec3(mesh.positions[mesh.indices[t + n]]); };
    // Of the end of the shaft, which is the section of the body there: fans about the axis.
    if (std::min({at(0).z, at(1).z, at(2).z}) < 39.999e-3) continue;
    area += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  for (const Vec3f& p : mesh.positions) {
    if (p.z < 5e-3f || p.z > 30e-3f) continue;
    least = std::min(least, std::hypot(static_cast<double>(p.x), static_cast<double>(p.y)));
    most = std::max(most, std::hypot(static_cast<double>(p.x), static_cast<double>(p.y)));
  }
  const double radius = 0.98 * 1.25e-3;
  CHECK(most == doctest::Approx(radius).epsilon(1e-5));
  CHECK(least == doctest::Approx(0.3 * radius).epsilon(1e-5));
  // The profile's share of the circle: straight stretches of r, each (r0^2 + r0 r1 + r1^2) / 3 of its share of the turn.
  const std::array<double, 9> at{0.0, 0.06, 0.08, 0.50, 0.58, 0.70, 0.84, 0.94, 1.0}, depth{0, 0, 0.06, 0.06, 0.55, 1.0, 1.0, 0.64, 0};
  double share = 0.0;
  for (std::size_t n = 0; n + 1 < at.size(); ++n) {
    const double a = 1.0 - 0.7 * depth[n], b = 1.0 - 0.7 * depth[n + 1];
    share += (at[n + 1] - at[n]) * (a * a + a * b + b * b) / 3.0;
  }
  CHECK(area / (kPi * radius * radius) == doctest::Approx(share).epsilon(0.01));  // chords of at most 6.3 degrees: 0.2 %
  CHECK(share > 0.5);  // of the section, as of drills; a body of two thirds of the diameter had 0.3 with its flutes
  CHECK(share < 0.7);
}

TEST_CASE("fluted mesh: the saw has ten pointed teeth at its edge, wider upwards, and none above their roots") {
  const ToolSpec spec = shipped_spec("sagittal_saw_12mm");
  const TriangleMesh mesh = make_fluted_mesh(spec);
  // Material along x through the middle of the blade, in two ranges at the set of the teeth.
  const auto at_tip = material_along_x(mesh, 0.11e-3, 0.02e-3);
  CHECK(at_tip.size() == 10);
  double last = 0.0;
  for (const double z : {0.02e-3, 0.3e-3, 0.57e-3, 1.0e-3, 1.6e-3}) {
    const auto teeth = material_along_x(mesh, 0.11e-3, z);
    double width = 0.0;
    for (const auto& [from, to] : teeth) width += to - from;
    CHECK(teeth.size() == 10);
    CHECK(width > last);
    last = width;
    // A tooth is a trapezoid: from 12 % of the pitch of 1.2 mm to all of it at four fifths of 2.08 mm.
    const double share = 0.12 + 0.88 * z / 1.664e-3;
    CHECK(std::abs(teeth[4].second - teeth[4].first - 1.2e-3 * share) < 1e-8);
    CHECK(std::abs(0.5 * (teeth[4].second + teeth[4].first) + 0.6e-3) < 1e-8);
  }
  const auto above = material_along_x(mesh, 0.11e-3, 1.9e-3);
  REQUIRE(above.size() == 1);
  CHECK(std::abs(above[0].second - above[0].first - 11.6e-3) < 1e-8);
  // Solids without teeth have one range there.
  CHECK(material_along_x(make_tool_mesh(spec), 0.11e-3, 0.02e-3).size() == 1);
}

TEST_CASE("fluted mesh: a burr's volume is that of its profile") {
  // A cylinder without twist has the same section everywhere: the polygon of the profile, whose area is half the sum of r_i r_(i+1) sin.
  const ToolSpec flat = tool_of({region(make_cylinder(0.0, 20e-3, 7e-3), 0.1, 1e-3)});
  const CuttingEdges edges = find_cutting_edges(flat);
  REQUIRE(edges.count == 4);
  REQUIRE(edges.twist == 0.0);
  const double whole = kPi * 49e-6 * 20e-3;
  // The flutes' share by the profile's corners: depth runs 0, 0, 0.35, 0.75, 1, 1, 0 at 0, 0.06, 0.30, 0.50, 0.70, 0.92, 1 of an edge's share,
  // r = R (1 - 0.13 depth); the integral of r^2 by Simpson's rule on each straight stretch (exact for squares) over R^2.
  const std::array<double, 7> at{0.0, 0.06, 0.30, 0.50, 0.70, 0.92, 1.0}, depth{0.0, 0.0, 0.35, 0.75, 1.0, 1.0, 0.0};
  double share = 0.0;
  for (std::size_t n = 0; n + 1 < at.size(); ++n) {
    const auto square = [&](double d) { return (1.0 - 0.13 * d) * (1.0 - 0.13 * d); };
    share += (at[n + 1] - at[n]) / 6.0 * (square(depth[n]) + 4.0 * square(0.5 * (depth[n] + depth[n + 1])) + square(depth[n + 1]));
  }
  // Chords of a 72-gon lose 0.1 %; the relief of the end takes at most 0.5 mm of 20 mm, about 0.5 of it on average: 1.3 %.
  CHECK(volume(make_fluted_mesh(flat)) == doctest::Approx(share * whole).epsilon(0.02));
  CHECK(share < 0.9);
}
