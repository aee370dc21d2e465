#include "core/tool/mesh_tool.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"
#include "core/base/units.h"
#include "core/tool/erosion_points.h"
#include "core/tool/make_tool.h"
#include "core/tool/point_shell.h"
#include "tests/core/tool/tool_samples.h"
#include "tests/support/mesh_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kMm = kMillimetre;

MeshToolSpec spec_of(double pitch, double factor = 0.1) {
  MeshToolSpec spec;
  spec.unit = kMm;
  spec.pitch = pitch;
  spec.erosion_factor = factor;
  spec.cut_to = 0.2;
  return spec;
}

PointShell shell_of(const MeshToolSpec& spec, const SurfaceMesh& mesh) {
  auto shell = make_mesh_shell(spec, mesh);
  REQUIRE_MESSAGE(shell.ok(), (shell ? "" : shell.error().text()));
  return std::move(shell).value();
}

/// Distance from p to the nearest shell point whose inward normal makes a cosine of at least `least` with `inward`.
double nearest(const PointShell& shell, const Vec3& p, const Vec3& inward, double least = 0.1) {
  double best = 1e9;
  for (std::size_t n = 0; n < shell.size(); ++n)
    if (glm::dot(shell.inward_normals[n], inward) > least) best = std::min(best, glm::distance(shell.positions[n], p));
  return best;
}

/// Largest distance from random points of the surface to the shell; points by area, at least 20 a triangle.
double largest_gap(const SurfaceMesh& mesh, const PointShell& shell, double pitch) {
  constexpr std::uint64_t kSeed = 77;
  double worst = 0.0;
  std::uint64_t counter = 0;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = mesh.positions[mesh.indices[n]], b = mesh.positions[mesh.indices[n + 1]], c = mesh.positions[mesh.indices[n + 2]];
    const Vec3 area = glm::cross(b - a, c - a);
    const auto count = static_cast<int>(std::min(2000.0, 3.0 + 20.0 * glm::length(area) / (pitch * pitch)));
    for (int m = 0; m < count; ++m) {
      double u = uniform01(kSeed, counter++), v = uniform01(kSeed, counter++);
      if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
      }
      worst = std::max(worst, nearest(shell, a + u * (b - a) + v * (c - a), -glm::normalize(area)));
    }
  }
  return worst;
}

double area_of(const SurfaceMesh& mesh) {
  double sum = 0.0;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = mesh.positions[mesh.indices[n]], b = mesh.positions[mesh.indices[n + 1]], c = mesh.positions[mesh.indices[n + 2]];
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

using Cell = std::array<int, 3>;
std::set<Cell> cells_of(const ErosionPoints& points) {
  std::set<Cell> cells;
  for (const Vec3& p : points.positions) {
    const Vec3i v = floor_int(p / points.pitch);
    cells.insert({v.x, v.y, v.z});
  }
  return cells;
}

const std::string kFile = "title = \"Burr\"\n[mesh]\nfile = \"burr.stl\"\nerosion_factor = 0.1\npitch_mm = 0.3\n";

/// make_tool on kFile with more lines; the mesh comes from memory, in mm as a file would hold it.
std::vector<std::string> faults(const std::string& text, const Result<SurfaceMesh>& mesh) {
  const auto document = TomlDocument::parse(text, "bits/bit.toml");
  REQUIRE_MESSAGE(document.ok(), (document ? "" : document.error().text()));
  Issues issues;
  const auto tool = make_tool(document.value(),
                              {.erosion_pitch = 0.25 * kMm,
                               .read_mesh =
                                   [&](const std::string& path, double unit) {
                                     CHECK(path == "bits/burr.stl");
                                     Result<SurfaceMesh> read = mesh;
                                     if (read)
                                       for (Vec3& p : read->positions) p *= unit;
                                     return read;
                                   }},
                              issues);
  CHECK(tool.has_value() == issues.empty());
  std::vector<std::string> lines;
  for (const Error& issue : issues) lines.push_back(issue.text());
  return lines;
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("mesh tool: a sphere's shell is the built-in sphere's, as dense and as even") {
  const double radius = 2 * kMm, pitch = 0.3 * kMm;
  const SurfaceMesh mesh = sphere_mesh({0, 0, radius}, radius, 5);
  const PointShell ours = shell_of(spec_of(pitch), mesh);
  const auto built_in = make_point_shell(tool_of({region(make_sphere(0.0, radius), 0.1, pitch)}));
  REQUIRE(built_in.ok());
  double there = 0.0, back = 0.0, tilt = 0.0;
  for (std::size_t n = 0; n < built_in->size(); ++n)
    there = std::max(there, nearest(ours, built_in->positions[n], built_in->inward_normals[n]));
  for (std::size_t n = 0; n < ours.size(); ++n) {
    back = std::max(back, nearest(*built_in, ours.positions[n], ours.inward_normals[n]));
    const Vec3 exact = glm::normalize(Vec3(0, 0, radius) - ours.positions[n]);
    tilt = std::max(tilt, std::acos(std::min(1.0, glm::dot(exact, ours.inward_normals[n]))));
    CHECK(ours.cutting[n] == 1);
  }
  MESSAGE(ours.size() << " points against " << built_in->size() << "; farthest " << there / pitch << " and " << back / pitch
                      << " pitches apart, normals " << tilt / kDegree << " degrees off");
  CHECK(there < pitch / std::sqrt(2.0));
  CHECK(back < pitch / std::sqrt(2.0) + 2e-6);  // the facets lie up to 1.2 um below the sphere
  CHECK(tilt < 1.6 * kDegree);  // edges of up to 0.041 radius tilt a facet's corner by 0.041 / sqrt(3) = 1.36 degrees, and its own size
  CHECK(ours.positions.front() == Vec3(0.0));  // the tip
  // A covering by circles of 0.707 pitch needs 0.77 a pitch^2 at best; the built-in rings have 1.1.
  CHECK(static_cast<double>(ours.size()) < 1.6 * static_cast<double>(built_in->size()));
  CHECK(static_cast<double>(ours.size()) > 0.8 * static_cast<double>(built_in->size()));
}

TEST_CASE("mesh tool: no gap of the shell is wider than pitch / sqrt 2, on any shape, and one point less is seen") {
  const Pose tilted{glm::angleAxis(0.5, glm::normalize(Vec3(1, 2, 3))), {0.1 * kMm, 0, 4 * kMm}};
  const SurfaceMesh needle = box_mesh({0.05 * kMm, 0.05 * kMm, 3 * kMm}, tilted);  // slivers
  const SurfaceMesh blade = box_mesh({2 * kMm, 0.1 * kMm, 3 * kMm}, tilted);       // thinner than the pitch: sides apart
  const SurfaceMesh coarse = sphere_mesh({0, 0, 2 * kMm}, 2 * kMm, 1), fine = sphere_mesh({0, 0, 2 * kMm}, 2 * kMm, 5);
  for (const SurfaceMesh* mesh : {&needle, &blade, &coarse, &fine})
    for (const double pitch : {0.3 * kMm, 0.7 * kMm}) {
      PointShell shell = shell_of(spec_of(pitch), *mesh);
      const double gap = largest_gap(*mesh, shell, pitch);
      MESSAGE(shell.size() << " points, " << static_cast<double>(shell.size()) * pitch * pitch / area_of(*mesh)
                           << " a pitch^2; largest gap " << gap / pitch << " pitches");
      CHECK(gap < pitch / std::sqrt(2.0));
      for (const Vec3& n : shell.inward_normals) CHECK(std::abs(glm::length(n) - 1.0) < 1e-12);
    }
  // Sabotage: without the points of one corner the gap passes the bound.
  PointShell shell = shell_of(spec_of(0.3 * kMm), blade);
  const Vec3 corner = blade.positions[0];
  for (std::size_t n = shell.size(); n-- > 0;)
    if (glm::distance(shell.positions[n], corner) < 0.4 * kMm) {
      shell.positions.erase(shell.positions.begin() + static_cast<std::ptrdiff_t>(n));
      shell.inward_normals.erase(shell.inward_normals.begin() + static_cast<std::ptrdiff_t>(n));
    }
  CHECK(largest_gap(blade, shell, 0.3 * kMm) > 0.3 * kMm / std::sqrt(2.0));
}

TEST_CASE("mesh tool: a sphere's erosion points are the built-in sphere's except for cells between chord and arc") {
  const double radius = 2 * kMm, pitch = 0.1 * kMm;
  const auto ours = make_mesh_erosion_points(spec_of(0.3 * kMm), sphere_mesh({0, 0, radius}, radius, 5), pitch);
  const auto built_in = make_erosion_points(tool_of({region(make_sphere(0.0, radius), 0.1, 0.3 * kMm)}), pitch);
  REQUIRE(ours.ok());
  REQUIRE(built_in.ok());
  const std::set<Cell> a = cells_of(*ours), b = cells_of(*built_in);
  CHECK(std::includes(b.begin(), b.end(), a.begin(), a.end()));
  std::size_t differ = 0;
  for (const Cell& c : b) {
    if (a.contains(c)) continue;
    ++differ;
    const double r = glm::length((Vec3(c[0], c[1], c[2]) + 0.5) * pitch - Vec3(0, 0, radius));
    CHECK(r > radius * (1.0 - 0.5 * 0.024 * 0.024));  // facets' corners are 0.024 from their middles
  }
  MESSAGE(a.size() << " erosion points, " << differ << " less than the built-in sphere");
  CHECK(a.size() > 30000);
  CHECK(differ < 60);  // area / pitch^2 = 5000 cells an edge deep: 0.012 of an edge
  for (const float f : ours->factors) CHECK(f == 0.1f);
  // The same order and the same bits where both have a point.
  std::size_t at = 0;
  for (const Vec3& p : built_in->positions)
    if (at < ours->size() && ours->positions[at] == p) ++at;
  CHECK(at == ours->size());
}

TEST_CASE("mesh tool: erosion points of any surface are the cells inside by the solid angle, at heights that cut") {
  const Pose tilted{glm::angleAxis(0.5, glm::normalize(Vec3(1, 2, 3))), {0.1 * kMm, 0, 4 * kMm}};
  const SurfaceMesh mesh = joined(box_mesh({2 * kMm, 1 * kMm, 3 * kMm}, tilted), inside_out(sphere_mesh(tilted.translation, 0.7 * kMm, 2)));
  MeshToolSpec spec = spec_of(0.3 * kMm);
  spec.cut_from = 2 * kMm;
  spec.cut_to = 5 * kMm;
  const double pitch = 0.21 * kMm;
  const auto points = make_mesh_erosion_points(spec, mesh, pitch);
  REQUIRE(points.ok());
  const std::set<Cell> found = cells_of(*points);
  CHECK(found.size() == points->size());
  for_each_voxel({Vec3i(-25, -25, 0), Vec3i(25, 25, 45)}, [&](const Vec3i& v) {
    const Vec3 p = (Vec3(v) + 0.5) * pitch;
    const bool expected = p.z >= spec.cut_from && p.z <= spec.cut_to && winding_number(mesh, p) > 0.5;
    CHECK(found.contains({v.x, v.y, v.z}) == expected);
  });
  const PointShell shell = shell_of(spec, mesh);
  for (std::size_t n = 0; n < shell.size(); ++n)
    CHECK(shell.cutting[n] == (shell.positions[n].z >= 2 * kMm && shell.positions[n].z <= 5 * kMm ? 1 : 0));
  spec.erosion_factor = 0.0;
  CHECK(make_mesh_erosion_points(spec, mesh, pitch)->size() == 0);
}

TEST_CASE("mesh tool: too many points are refused before they are made") {
  const SurfaceMesh mesh = sphere_mesh({0, 0, 20 * kMm}, 20 * kMm, 3);
  CHECK(make_mesh_shell(spec_of(0.05 * kMm), mesh).error().message ==
        "a pitch_mm of 0.05 makes more than 200000 shell points: take a larger one");
  CHECK(make_mesh_erosion_points(spec_of(1 * kMm), mesh, 0.05 * kMm).error().message ==
        "an erosion pitch of 0.05 mm makes more than 20000000 erosion points: take a coarser pitch");
  CHECK(make_mesh_erosion_points(spec_of(1 * kMm), mesh, 1e-12).error().code == ErrorCode::out_of_range);
  CHECK(make_mesh_erosion_points(spec_of(1 * kMm), mesh, -1.0).error().message == "erosion pitch = -1000 mm must be > 0");
}

TEST_CASE("mesh tool file: unit, turn and shift bring a file to its tip") {
  // A box from y = 9.5 to 10.5 cm with its tip at the far end: -90 degrees about x send y to -z and z to y.
  SurfaceMesh mesh = box_mesh({0.2, 0.5, 0.3}, {Quat(0.0, 0.0, 0.0, 1.0), {1.0, 10.0, 2.0}});  // cm
  const std::string turned = kFile + "unit_mm = 10\nturn_deg = [-90, 0, 0]\n", good = turned + "shift_mm = [-10, -20, 105]\n";
  CHECK(faults(turned, mesh).at(0).find("lowest point at z = -105 mm") != std::string::npos);
  CHECK(faults(good, mesh) == Lines{});
  const auto document = TomlDocument::parse(good, "bits/bit.toml");
  Issues issues;
  const auto spec = read_mesh_tool_spec(*document, issues);
  REQUIRE(spec);
  for (Vec3& p : mesh.positions) p *= spec->unit;
  const Vec3 low = spec->turn * (0.01 * Vec3(1.0, 10.5, 2.0)) + spec->shift;
  CHECK(glm::length(low) < 1e-15);
}

TEST_CASE("mesh tool file: a gap of a rounding is closed and named") {
  SurfaceMesh ball = sphere_mesh({0, 0, 2}, 2, 2);
  const auto repair = [](const SurfaceMesh& mesh) {
    const auto document = TomlDocument::parse(kFile, "bits/bit.toml");
    Issues issues;
    const auto read = [&](const std::string&, double unit) {
      Result<SurfaceMesh> scaled = mesh;
      for (Vec3& p : scaled->positions) p *= unit;
      return scaled;
    };
    const ToolOptions options{.erosion_pitch = 0.25 * kMm, .read_mesh = read};
    REQUIRE(make_tool(*document, options, issues));
    return find_tool_repair(*document, options);
  };
  CHECK(repair(ball) == "");
  ball.positions.push_back(ball.positions[ball.indices[0]] + Vec3(-2.9e-16, 0.0, 0.0));
  ball.indices[0] = static_cast<std::uint32_t>(ball.positions.size() - 1);
  CHECK(repair(ball) ==
        "mesh.file = \"burr.stl\": 1 vertex of an open edge lies within 9.5e-07 mm of another, a rounding of 32-bit coordinates: joined");
  // Sabotage: a gap of ten times that is an opening.
  ball.positions.back().x -= 1e-5;
  CHECK(faults(kFile, ball).at(0).find("is not a solid, open: 4 edges without a neighbour") != std::string::npos);
}

TEST_CASE("mesh tool file: errors are reported with their line and column") {
  SurfaceMesh ball = sphere_mesh({0, 0, 2}, 2, 2);
  CHECK(faults(kFile, ball) == Lines{});
  SurfaceMesh open = ball;
  open.indices.resize(open.indices.size() - 3);
  CHECK(faults(kFile, open)
            .at(0)
            .rfind("bits/bit.toml:3:1: mesh.file = \"burr.stl\" is not a solid, open: 3 edges without a neighbour in 1 hole, the longest ",
                   0) == 0);
  CHECK(faults(kFile, inside_out(ball)).at(0).rfind("bits/bit.toml:3:1: mesh.file = \"burr.stl\" is not a solid, inside-out: ", 0) == 0);
  CHECK(faults(kFile, bad_input("cannot be read: No such file or directory", "bits/burr.stl")) ==
        Lines{"bits/bit.toml:3:1: mesh.file = \"burr.stl\" cannot be read: No such file or directory"});
  CHECK(faults(kFile, sphere_mesh({0, 0, 3}, 2, 2)) ==
        Lines{"bits/bit.toml:3:1: mesh.file = \"burr.stl\" has its lowest point at z = 1 mm and must stand on z = 0: the tip is the origin "
              "(shift_mm, turn_deg)"});
  CHECK(faults(kFile, sphere_mesh({9, 0, 2}, 2, 2)).at(0).find("lies beside the axis") != std::string::npos);
  CHECK(faults(kFile + "unit_mm = 25.4\n", ball).at(0).find("reaches 50.8 mm from the axis") != std::string::npos);
  CHECK(faults(kFile + "unit_mm = 0.001\n", ball).at(0).find("needs unit_mm = 1000") != std::string::npos);
  CHECK(faults(kFile + "cutting_range_mm = [2, 1]\n", ball) ==
        Lines{"bits/bit.toml:6:1: mesh.cutting_range_mm must rise from its first height to its second"});
  CHECK(faults(kFile + "colour = 1\n", ball) == Lines{"bits/bit.toml:6:1: unknown key \"colour\" in [mesh]"});
  CHECK(faults(kFile + "[[region]]\nshape = \"sphere\"\n", ball).at(0) ==
        "bits/bit.toml:6:3: region cannot stand beside [mesh]: a tool is either regions or one surface");
  CHECK(faults("title = \"x\"\n[mesh]\n", ball).size() == 3);
  const auto document = TomlDocument::parse(kFile, "bits/bit.toml");
  Issues issues;
  CHECK_FALSE(make_tool(*document, {}, issues));
  CHECK(issues.at(0).message == "mesh.file = \"burr.stl\" cannot be read: this program has no mesh reader");
}
