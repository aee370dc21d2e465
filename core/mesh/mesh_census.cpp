#include "core/mesh/mesh_census.h"

#include <algorithm>
#include <tuple>

namespace burrhole {
namespace {

using Id = HalfEdgeMesh::Id;

bool is_open(const HalfEdgeMesh& mesh, Id h) { return mesh.partner(h) == HalfEdgeMesh::kFront || mesh.partner(h) == HalfEdgeMesh::kBorder; }

/// Calls f(half-edge) for each that is in use.
template <class F>
void for_each_half_edge(const HalfEdgeMesh& mesh, F&& f) {
  for (Id triangle = 0; triangle < mesh.triangle_slots(); ++triangle)
    if (mesh.has_triangle(triangle))
      for (Id n = 0; n < 3; ++n) f(3 * triangle + n);
}

/// A fan is a cycle of half-edges that begin at one vertex, or a path that ends at an open edge.
std::size_t count_fans(const HalfEdgeMesh& mesh) {
  std::vector<bool> seen(3 * static_cast<std::size_t>(mesh.triangle_slots()));
  std::size_t fans = 0;
  for_each_half_edge(mesh, [&](Id start) {
    if (seen[start]) return;
    ++fans;
    for (Id h = start; !seen[h];) {
      seen[h] = true;
      if (is_open(mesh, mesh.previous(h))) break;
      h = mesh.partner(mesh.previous(h));
    }
    for (Id h = start; !is_open(mesh, h);) {
      h = mesh.next(mesh.partner(h));
      if (seen[h]) break;
      seen[h] = true;
    }
  });
  return fans;
}

std::size_t count_parts(const HalfEdgeMesh& mesh) {
  std::vector<bool> seen(mesh.triangle_slots());
  std::vector<Id> waiting;
  std::size_t parts = 0;
  const auto visit = [&](Id triangle) {
    if (seen[triangle]) return false;
    seen[triangle] = true;
    waiting.push_back(triangle);
    return true;
  };
  for (Id first = 0; first < mesh.triangle_slots(); ++first) {
    if (!mesh.has_triangle(first) || !visit(first)) continue;
    ++parts;
    while (!waiting.empty()) {
      const Id triangle = waiting.back();
      waiting.pop_back();
      for (Id n = 0; n < 3; ++n)
        if (!is_open(mesh, 3 * triangle + n)) visit(mesh.partner(3 * triangle + n) / 3);
    }
  }
  return parts;
}

std::vector<std::array<Vec3i, 2>> shared_edges(const HalfEdgeMesh& mesh) {
  std::vector<std::array<Id, 2>> ends;
  for_each_half_edge(mesh, [&](Id h) {
    ends.push_back({std::min(mesh.origin(h), mesh.target(h)), std::max(mesh.origin(h), mesh.target(h))});
  });
  std::ranges::sort(ends);
  const auto key = [](const Vec3i& v) { return std::tuple(v.z, v.y, v.x); };
  std::vector<std::array<Vec3i, 2>> out;
  for (std::size_t n = 0, end = 0; n < ends.size(); n = end) {
    while (end < ends.size() && ends[end] == ends[n]) ++end;
    if (end - n <= 2) continue;
    std::array<Vec3i, 2> edge{mesh.voxel(ends[n][0]), mesh.voxel(ends[n][1])};
    if (key(edge[1]) < key(edge[0])) std::swap(edge[0], edge[1]);
    out.push_back(edge);
  }
  std::ranges::sort(out, {}, [&](const auto& edge) { return std::pair(key(edge[0]), key(edge[1])); });
  return out;
}

}  // namespace

MeshCensus take_census(const BallMesh& ball_mesh) {
  const HalfEdgeMesh& mesh = ball_mesh.half_edges();
  MeshCensus out;
  out.triangles = mesh.triangles();
  out.vertices = mesh.vertices();
  for_each_half_edge(mesh, [&](Id h) {
    if (is_open(mesh, h)) ++out.open_edges;
    if (is_open(mesh, h) || h < mesh.partner(h)) ++out.edges;
    if (h % 3 != 0) return;
    const Vec3 a = ball_mesh.position(h), b = ball_mesh.position(mesh.next(h)), c = ball_mesh.position(mesh.previous(h));
    out.volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  });
  out.corners = count_fans(mesh);
  out.parts = count_parts(mesh);
  out.shared_edges = shared_edges(mesh);
  return out;
}

std::vector<OrphanVoxel> find_orphans(const BallMesh& mesh) {
  std::vector<OrphanVoxel> out;
  for_each_voxel(mesh.box(), [&](const Vec3i& voxel) {
    if (!mesh.is_surface(voxel) || mesh.state(voxel) != HalfEdgeMesh::VertexState::orphan) return;
    OrphanVoxel orphan{.voxel = voxel};
    for (unsigned code = 0; code < 27; ++code)
      if (step_of_code(code) != Vec3i(0) && mesh.is_solid(voxel + step_of_code(code))) ++orphan.neighbours;
    out.push_back(orphan);
  });
  return out;
}

}  // namespace burrhole
