#include "core/tool/tool_mesh.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "tests/core/tool/tool_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

using Key = std::array<float, 3>;

Vec3 at(const TriangleMesh& mesh, std::size_t corner) { return Vec3(mesh.positions[mesh.indices[corner]]); }

double mesh_volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) sum += glm::dot(at(mesh, t), glm::cross(at(mesh, t + 1), at(mesh, t + 2))) / 6.0;
  return sum;
}

/// Number of directed edges without exactly one partner in the other direction, corners welded by position.
std::size_t open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<Key, Key>, int> edges;
  const auto key = [&](std::size_t corner) {
    const Vec3f p = mesh.positions[mesh.indices[corner]];
    return Key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 becomes 0
  };
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{key(t + i), key(t + (i + 1) % 3)}];
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    open += count == 1 && back != edges.end() && back->second == 1 ? 0 : 1;
  }
  return open;
}

ToolSpec box_tool() { return tool_of({region(make_box({.height = 2e-3, .size = {3e-3, 4e-3}, .centre = {1e-3, -1e-3}}), 0.1, 1e-3)}); }

/// A prism of n flats holds this share of the round solid.
double share(int slices) { return slices / (2.0 * kPi) * std::sin(2.0 * kPi / slices); }

}  // namespace

TEST_CASE("mesh: closed and consistently turned: every edge once in each direction") {
  const ToolSpec cone = tool_of({region(make_cone(0.0, 4e-3, 2e-3), 0.1, 1e-3), region(make_sphere(2e-3, 1.5e-3), 0.1, 1e-3)});
  for (const ToolSpec& spec : {perforator(1e-3), burr(1e-3), cone, trephine(1e-3), ring(1e-3), box_tool()})
    for (const int slices : {3, 64}) {
      const TriangleMesh mesh = make_tool_mesh(spec, slices, 16);
      CHECK(mesh.positions.size() == mesh.normals.size());
      CHECK(mesh.indices.size() % 3 == 0);
      CHECK(open_edges(mesh) == 0);
    }
}

TEST_CASE("mesh: sabotage: a missing or a flipped triangle is found") {
  TriangleMesh mesh = make_tool_mesh(perforator(1e-3));
  std::swap(mesh.indices[30], mesh.indices[31]);
  CHECK(open_edges(mesh) > 0);
  mesh = make_tool_mesh(perforator(1e-3));
  mesh.indices.resize(mesh.indices.size() - 3);
  CHECK(open_edges(mesh) > 0);
}

TEST_CASE("mesh: its volume is the closed form, shortened by the flats only") {
  const double stacked = kPi * (5.5e-3 * 5.5e-3 * 3e-3 + 7e-3 * 7e-3 * 9e-3);
  for (const int slices : {8, 64}) {
    // positions are float: 1e-7 of a coordinate
    CHECK(mesh_volume(make_tool_mesh(perforator(1e-3), slices)) == doctest::Approx(share(slices) * stacked).epsilon(1e-5));
    const ToolSpec cone = tool_of({region(make_cone(0.0, 4e-3, 2e-3), 0.1, 1e-3)});
    CHECK(mesh_volume(make_tool_mesh(cone, slices)) == doctest::Approx(share(slices) * cone.regions[0].solid.volume()).epsilon(1e-5));
  }
  const ToolSpec tube = ring(1e-3);
  CHECK(mesh_volume(make_tool_mesh(tube)) == doctest::Approx(share(64) * tube.regions[0].solid.volume()).epsilon(1e-5));
  CHECK(mesh_volume(make_tool_mesh(box_tool())) == doctest::Approx(24e-9).epsilon(1e-5));
  const ToolSpec ball = tool_of({region(make_sphere(0.0, 2e-3), 0.1, 1e-3)});
  // arcs of n straight steps over half a turn lose about (pi / n)^2 / 4 of the volume: 6e-5 at 200
  CHECK(mesh_volume(make_tool_mesh(ball, 200, 200)) == doctest::Approx(share(200) * ball.regions[0].solid.volume()).epsilon(1e-4));
}

TEST_CASE("mesh: normals have length 1 and point the way their triangles face") {
  for (const ToolSpec& spec : {perforator(1e-3), burr(1e-3), trephine(1e-3), box_tool()}) {
    const TriangleMesh mesh = make_tool_mesh(spec);
    for (const Vec3f& n : mesh.normals) CHECK(std::abs(glm::length(n) - 1.0f) < 1e-6f);  // float rounding
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      const Vec3 face = glm::normalize(glm::cross(at(mesh, t + 1) - at(mesh, t), at(mesh, t + 2) - at(mesh, t)));
      // a flat is at most half a step round (2.8 degrees) and half a step along the arc from its corners' normals: cos > 0.98
      for (std::size_t i = 0; i < 3; ++i) CHECK(glm::dot(face, Vec3(mesh.normals[mesh.indices[t + i]])) > 0.98);
    }
  }
}
