#include "core/tool/point_shell.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "tests/core/tool/tool_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

RegionSpec counted(const Solid& solid, int stacks, int slices) {
  RegionSpec spec = region(solid, 0.1, 0.0);
  spec.shell.stacks = stacks;
  spec.shell.slices = slices;
  return spec;
}

PointShell shell_of(const ToolSpec& spec) {
  auto shell = make_point_shell(spec);
  REQUIRE(shell.ok());
  REQUIRE(shell.value().positions.size() == shell.value().inward_normals.size());
  REQUIRE(shell.value().positions.size() == shell.value().cutting.size());
  return std::move(shell).value();
}

std::vector<ToolSpec> tools() {
  return {perforator(0.7e-3), burr(0.4e-3), tool_of({counted(make_sphere(0.0, 2e-3), 8, 14)}),
          tool_of({counted(make_cylinder(0.0, 13.5e-3, 7e-3), 8, 26)}), tool_of({region(make_cone(0.0, 4e-3, 2e-3), 0.1, 0.3e-3)})};
}

/// Those whose surface has a bore, flat sides, or both with a round hub.
std::vector<ToolSpec> other_tools() {
  return {trephine(0.5e-3), ring(0.4e-3), saw(0.5e-3), tool_of({region(make_box({.height = 3e-3, .size = {2e-3, 5e-3}}), 0.1, 0.5e-3)})};
}

std::vector<ToolSpec> all_tools() {
  std::vector<ToolSpec> all = tools();
  for (ToolSpec& spec : other_tools()) all.push_back(std::move(spec));
  return all;
}

double nearest_distance(const PointShell& shell, const Vec3& p, std::size_t skip = ~std::size_t{0}) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i)
    if (i != skip) best = std::min(best, glm::length(shell.positions[i] - p));
  return best;
}

/// Least over points of the distance to the nearest other point, and the greatest.
struct Spread {
  double least, greatest;
};

Spread spread(const PointShell& shell) {
  Spread result{std::numeric_limits<double>::infinity(), 0.0};
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const double d = nearest_distance(shell, shell.positions[i], i);
    result = {std::min(result.least, d), std::max(result.greatest, d)};
  }
  return result;
}

/// Number of points that have no partner (position and normal) in the shell mirrored by `mirror`.
std::size_t without_mirror_image(const PointShell& shell, const Vec3& mirror) {
  std::size_t lonely = 0;
  for (std::size_t i = 0; i < shell.size(); ++i) {
    bool found = false;
    for (std::size_t j = 0; j < shell.size() && !found; ++j)
      found = glm::length(shell.positions[j] - mirror * shell.positions[i]) < 1e-12 &&  // rounding of millimetres
              glm::length(shell.inward_normals[j] - mirror * shell.inward_normals[i]) < 1e-9 && shell.cutting[j] == shell.cutting[i];
    lonely += found ? 0 : 1;
  }
  return lonely;
}

/// Greatest distance from random points of the tool's surface to the shell.
double greatest_gap(const ToolSpec& spec, const PointShell& shell, int count) {
  double most = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto c = static_cast<std::uint64_t>(i);
    const OutlinePiece& piece = spec.outline[mix64(c) % spec.outline.size()];
    const Meridian at = piece.point(uniform01(21, 2 * c));
    const double angle = 2.0 * kPi * uniform01(21, 2 * c + 1);
    most = std::max(most, nearest_distance(shell, {at.x * std::cos(angle), at.x * std::sin(angle), at.y}));
  }
  return most;
}

}  // namespace

TEST_CASE("shell: stacks and slices give the 316 and the 72 points of the paper") {
  CHECK(shell_of(tool_of({counted(make_cylinder(0.0, 13.5e-3, 7e-3), 8, 26)})).size() == 316);
  CHECK(shell_of(tool_of({counted(make_sphere(0.0, 2e-3), 8, 14)})).size() == 72);
}

TEST_CASE("shell: normals have length 1 and point into the tool, at rims and inner corners too") {
  for (const ToolSpec& spec : all_tools()) {
    const PointShell shell = shell_of(spec);
    for (std::size_t i = 0; i < shell.size(); ++i) {
      CAPTURE(shell.positions[i].z);
      CHECK(std::abs(glm::length(shell.inward_normals[i]) - 1.0) < 1e-14);  // rounding
      CHECK(inside_any(spec, shell.positions[i] + 1e-7 * shell.inward_normals[i]));
      CHECK_FALSE(inside_any(spec, shell.positions[i] - 1e-7 * shell.inward_normals[i]));
    }
  }
}

TEST_CASE("shell: sabotage: with normals flipped the inside check fails at every point") {
  const ToolSpec spec = perforator(0.7e-3);
  PointShell shell = shell_of(spec);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < shell.size(); ++i) inside += inside_any(spec, shell.positions[i] - 1e-7 * shell.inward_normals[i]) ? 1 : 0;
  CHECK(inside == 0);
}

TEST_CASE("shell: every point lies on the surface of the union, none inside another region") {
  for (const ToolSpec& spec : all_tools())
    for (const Vec3& p : shell_of(spec).positions) {
      // arcs are measured on chords of 1/128 turn, 1.5e-7 m off at a radius of 2 mm
      CHECK(std::abs(signed_distance(spec.solids(), spec.outline, p)) < 2e-7);
    }
}

TEST_CASE("shell: the first point is the tip, on the axis, and looks up the shaft") {
  for (const ToolSpec& spec : tools()) {
    const PointShell shell = shell_of(spec);
    CHECK(shell.positions.front() == Vec3(0.0));
    CHECK(shell.inward_normals.front() == Vec3(0.0, 0.0, 1.0));
    CHECK(shell.positions.back().x == 0.0);
    CHECK(shell.inward_normals.back() == Vec3(0.0, 0.0, -1.0));
  }
}

TEST_CASE("shell: mirror symmetric in x and in y") {
  for (const ToolSpec& spec : all_tools()) {
    const PointShell shell = shell_of(spec);
    CHECK(without_mirror_image(shell, {-1.0, 1.0, 1.0}) == 0);
    CHECK(without_mirror_image(shell, {1.0, -1.0, 1.0}) == 0);
  }
}

TEST_CASE("shell: sabotage: a shell turned by a third of a step is not symmetric") {
  PointShell shell = shell_of(perforator(0.7e-3));
  const Quat turn = glm::angleAxis(0.03, Vec3(0.0, 0.0, 1.0));
  for (Vec3& p : shell.positions) p = turn * p;
  CHECK(without_mirror_image(shell, {-1.0, 1.0, 1.0}) > shell.size() / 2);
}

TEST_CASE("shell: a sphere's shell is mirror symmetric up and down") {
  PointShell shell = shell_of(tool_of({counted(make_sphere(0.0, 2e-3), 8, 14)}));
  for (Vec3& p : shell.positions) p.z -= 2e-3;
  CHECK(without_mirror_image(shell, {1.0, 1.0, -1.0}) == 0);
}

TEST_CASE("shell: no two points coincide and gaps are alike") {
  for (const ToolSpec& spec : {perforator(0.7e-3), tools()[2], tools()[3]}) {
    const Spread gaps = spread(shell_of(spec));
    // Along a ring the gap is at least 2/3 of the wanted one (8 points where 2 pi = 6.3 would do; nearest even of 5.4 is 6), between
    // rings at least 2/3 (length rounded up to whole rows, the ledge of 1.5 mm by 0.7 has 3): a ratio of 2 leaves no room for a duplicate.
    CHECK(gaps.least > 0.5 * gaps.greatest);
  }
}

TEST_CASE("shell: by pitch, no point of the surface is further than 3/4 pitch from a shell point") {
  // rings at most a pitch apart, points of a ring too: sqrt(2)/2 pitch on a flat strip, a little more between rings of different radius
  const ToolSpec drill = perforator(0.7e-3);
  CHECK(greatest_gap(drill, shell_of(drill), 20000) < 0.75 * 0.7e-3);
  const ToolSpec ball = burr(0.2e-3);
  CHECK(greatest_gap(ball, shell_of(ball), 20000) < 0.75 * 0.2e-3);
}

TEST_CASE("shell: sabotage: with one point taken out the gap check fails") {
  const ToolSpec drill = perforator(0.7e-3);
  PointShell shell = shell_of(drill);
  shell.positions.erase(shell.positions.begin() + 40);
  shell.inward_normals.erase(shell.inward_normals.begin() + 40);
  CHECK(greatest_gap(drill, shell, 200000) > 0.75 * 0.7e-3);
}

TEST_CASE("shell: its points share the surface evenly, so forces on a ball pressed from all sides cancel") {
  for (const ToolSpec& spec : all_tools()) {
    const PointShell shell = shell_of(spec);
    Vec3 sum(0.0);
    for (const Vec3& n : shell.inward_normals) sum += n;
    CHECK(std::hypot(sum.x, sum.y) < 1e-9);  // rings are symmetric; rounding of a few thousand terms
  }
}

TEST_CASE("shell: cutting follows region and face") {
  const PointShell whole = shell_of(burr(0.4e-3));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool head = whole.positions[i].z <= 2e-3 + std::sqrt(4e-6 - 0.81e-6) + 1e-9;  // down to the joint of head and shank, which cuts
    CHECK(whole.cutting[i] == (head ? 1 : 0));
  }
  ToolSpec front = perforator(0.7e-3);
  for (RegionSpec& one : front.regions) one.erosion.side = one.erosion.top = 0.0;
  const PointShell faces = shell_of(front);
  CHECK(std::ranges::count(whole.cutting, 0) > 0);
  CHECK(std::ranges::count(whole.cutting, 1) > 0);
  CHECK(std::ranges::count(faces.cutting, 1) > 0);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double z = faces.positions[i].z;
    const bool bottom = std::abs(z) < 1e-9 || std::abs(z - 3e-3) < 1e-9;
    CHECK(faces.cutting[i] == (bottom ? 1 : 0));
  }
}

TEST_CASE("shell: rings are laid like bricks, each half a step from the one below") {
  const PointShell shell = shell_of(tool_of({counted(make_cylinder(0.0, 13.5e-3, 7e-3), 8, 26)}));
  std::vector<Vec3> firsts;  // first point of each ring of the side, bottom rim to top rim
  for (const Vec3& p : shell.positions)
    if (std::hypot(p.x, p.y) > 6.9e-3 && (firsts.empty() || p.z > firsts.back().z + 1e-4)) firsts.push_back(p);
  REQUIRE(firsts.size() == 9);
  for (std::size_t i = 1; i < firsts.size(); ++i) {
    const Vec3 a(firsts[i - 1].x, firsts[i - 1].y, 0.0), b(firsts[i].x, firsts[i].y, 0.0);
    CHECK(glm::dot(a, b) / 49e-6 == doctest::Approx(std::cos(kPi / 26.0)).epsilon(1e-12));
  }
}

TEST_CASE("shell: an edge between a dense and a sparse region has the dense ring, once") {
  for (const bool dense_below : {true, false}) {
    const ToolSpec spec = tool_of({counted(make_cylinder(0.0, 4e-3, 3e-3), 4, dense_below ? 26 : 12),
                                   counted(make_cylinder(4e-3, 4e-3, 3e-3), 4, dense_below ? 12 : 26)});
    const PointShell shell = shell_of(spec);
    CHECK(std::count_if(shell.positions.begin(), shell.positions.end(), [](const Vec3& p) { return std::abs(p.z - 4e-3) < 1e-9; }) == 26);
  }
}

TEST_CASE("shell: voxel bounds the gap between the rings of flat faces") {
  RegionSpec fine = counted(make_cylinder(0.0, 13.5e-3, 7e-3), 8, 26);
  fine.shell.voxel = 1e-3;
  const PointShell shell = shell_of(tool_of({fine}));
  std::vector<double> radii;
  for (const Vec3& p : shell.positions)
    if (p.z == 0.0) radii.push_back(std::hypot(p.x, p.y));
  std::sort(radii.begin(), radii.end());
  REQUIRE(radii.size() > 7);  // the rim's 7 mm by steps of a millimetre
  CHECK(radii.front() < 1e-12);
  for (std::size_t i = 1; i < radii.size(); ++i) CHECK(radii[i] - radii[i - 1] <= 1e-3 + 1e-12);
}

TEST_CASE("shell: too many points are refused, not allocated") {
  const auto shell = make_point_shell(tool_of({region(make_cylinder(0.0, 200e-3, 50e-3), 0.1, 1e-6)}));
  REQUIRE_FALSE(shell.ok());
  CHECK(shell.error().code == ErrorCode::out_of_range);
}

TEST_CASE("shell: the wall of a bore has points, and their normals point outwards, into the wall") {
  for (const ToolSpec& spec : {trephine(0.5e-3), ring(0.4e-3)}) {
    const PointShell shell = shell_of(spec);
    std::size_t inner = 0;
    for (std::size_t i = 0; i < shell.size(); ++i) {
      const Vec3& p = shell.positions[i];
      const NearestFace near = find_nearest_face(spec.solids(), spec.outline, p + 1e-5 * shell.inward_normals[i]);
      const glm::dvec2 away = glm::dvec2(p) / std::hypot(p.x, p.y);
      if (near.face != Face::inner || std::abs(shell.inward_normals[i].z) > 0.5) continue;
      ++inner;
      CHECK(glm::dot(glm::dvec2(shell.inward_normals[i]), away) > 0.7);  // edges are halfway: 45 degrees
    }
    CHECK(inner > 100);
  }
}

TEST_CASE("shell: a ring has no pole and an edge at the joint of its line, once") {
  const PointShell shell = shell_of(ring(0.4e-3));
  for (const Vec3& p : shell.positions) CHECK(std::hypot(p.x, p.y) > 1.9e-3);
  const Spread gaps = spread(shell);
  CHECK(gaps.least > 0.4 * gaps.greatest);  // rows rounded up on a bottom of 1 mm by 0.4, rings to even counts: no duplicate
}

TEST_CASE("shell: a box has rows at most a pitch apart, halfway normals on edges and corners") {
  const ToolSpec spec = other_tools()[3];
  const PointShell shell = shell_of(spec);
  CHECK(shell.size() == 2 * (4 * 10 + 10 * 6 + 6 * 4) + 2);  // 4, 10 and 6 gaps
  std::size_t corners = 0, edges = 0;
  for (const Vec3& n : shell.inward_normals) {
    const int parts = (n.x != 0.0) + (n.y != 0.0) + (n.z != 0.0);
    corners += parts == 3 ? 1 : 0;
    edges += parts == 2 ? 1 : 0;
  }
  CHECK(corners == 8);
  CHECK(edges == 4 * (3 + 9 + 5));
}

TEST_CASE("shell: gaps stay bounded on bores, boxes, and where a box runs into a hub") {
  // Random points of each solid's own surface that nothing covers.
  const auto worst = [](const ToolSpec& spec, double pitch) {
    const PointShell shell = shell_of(spec);
    const std::vector<Solid> solids = spec.solids();
    const bool round = std::all_of(solids.begin(), solids.end(), [](const Solid& solid) { return solid.revolves(); });
    double most = round ? greatest_gap(spec, shell, 5000) : 0.0;
    for (std::uint64_t i = 0; i < 20000; ++i)
      for (std::size_t n = 0; n < solids.size(); ++n) {
        if (solids[n].revolves()) continue;
        const Bounds box = solids[n].bounds();
        const BoxFace face = box_faces()[i % 6];
        Vec3 p = random_point(77 + n, i, box.lo, box.hi), outward(0.0);
        p[face.axis] = face.sign < 0.0 ? box.lo[face.axis] : box.hi[face.axis];
        outward[face.axis] = face.sign;
        if (!is_covered(solids, n, p, outward)) most = std::max(most, nearest_distance(shell, p));
      }
    return most / pitch;
  };
  CHECK(worst(ring(0.4e-3), 0.4e-3) < 0.75);
  CHECK(worst(trephine(0.5e-3), 0.5e-3) < 0.75);
  CHECK(worst(other_tools()[3], 0.5e-3) < 0.75);
  // Where the blade enters the hub there is no row of its own: the last free one is up to a pitch away, its points half a pitch aside.
  CHECK(worst(saw(0.5e-3), 0.5e-3) < 1.12);
}

TEST_CASE("shell: a saw's edge cuts, its flats and its back do not") {
  const PointShell shell = shell_of(saw(0.5e-3));
  for (std::size_t i = 0; i < shell.size(); ++i) CHECK(shell.cutting[i] == (shell.positions[i].z == 0.0 ? 1 : 0));
  CHECK(std::count(shell.cutting.begin(), shell.cutting.end(), 1) == 25 * 3);
}
