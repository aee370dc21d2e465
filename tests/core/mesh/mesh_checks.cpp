#include "tests/core/mesh/mesh_checks.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "core/mesh/mesh_census.h"
#include "core/tool/surface_mesh.h"
#include "tests/core/mesh/pivot_twin.h"

namespace burrhole::test {
namespace {

using Id = HalfEdgeMesh::Id;

bool is_open(Id partner) { return partner == HalfEdgeMesh::kFront || partner == HalfEdgeMesh::kBorder; }

std::string at(const Vec3i& v) { return " at " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z); }

bool is_empty_ball(const MeshBone& bone, const Vec3& ball) {
  bool empty = true;
  const Vec3i nearest = voxel_of(ball);
  for_each_voxel({nearest - 2, nearest + 3},
                 [&](const Vec3i& v) { empty = empty && !(bone.is_solid(v) && glm::length(Vec3(v) - ball) < kBallRadius - 1e-9); });
  return empty;
}

/// The mesh on the voxel centres, with one vertex per voxel.
SurfaceMesh at_centres(const HalfEdgeMesh& mesh) {
  SurfaceMesh out;
  for (Id vertex = 0; vertex < mesh.vertex_slots(); ++vertex) out.positions.emplace_back(mesh.voxel(vertex));
  for (Id h = 0; h < 3 * mesh.triangle_slots(); ++h)
    if (mesh.has_triangle(h / 3)) out.indices.push_back(mesh.origin(h));
  return out;
}

std::string triangle_error(const HalfEdgeMesh& mesh, const MeshBone& bone) {
  std::set<PlainTriangle> known;
  for (Id t = 0; t < mesh.triangle_slots(); ++t) {
    if (!mesh.has_triangle(t)) continue;
    const Vec3i a = mesh.voxel(mesh.origin(3 * t)), b = mesh.voxel(mesh.target(3 * t)), c = mesh.voxel(mesh.opposite(3 * t));
    if (a == b || b == c || a == c) return "a degenerate triangle" + at(a);
    for (const Vec3i& v : {a, b, c})
      if (!bone.is_solid(v)) return "a triangle on a voxel that is gone" + at(v);
    if (!known.insert(plain_triangle(a, b, c)).second) return "a triangle twice" + at(a);
    for (Id h = 3 * t; h < 3 * t + 3; ++h) {
      const Id other = mesh.partner(h);
      if (is_open(other)) continue;
      if (!mesh.has_triangle(other / 3) || mesh.partner(other) != h) return "a partner that is not mutual" + at(a);
      if (mesh.origin(other) != mesh.target(h) || mesh.target(other) != mesh.origin(h)) return "a partner that is not the reverse" + at(a);
    }
  }
  return {};
}

}  // namespace

std::string front_error(const BallMesh& ball_mesh, const MeshBone& bone) {
  const HalfEdgeMesh& mesh = ball_mesh.half_edges();
  if (std::string error = triangle_error(mesh, bone); !error.empty()) return error;
  std::map<Id, int> balance, open;
  std::size_t front = 0;
  std::map<std::array<int, 3>, Id> used;
  for (Id h = 0; h < 3 * mesh.triangle_slots(); ++h) {
    if (!mesh.has_triangle(h / 3)) continue;
    const Vec3i from = mesh.voxel(mesh.origin(h));
    if (used.try_emplace({from.z, from.y, from.x}, mesh.origin(h)).first->second != mesh.origin(h))
      return "two vertices of a voxel" + at(from);
    if (!is_open(mesh.partner(h))) continue;
    ++balance[mesh.origin(h)];
    --balance[mesh.target(h)];
    ++open[mesh.origin(h)];
    ++open[mesh.target(h)];
    if (mesh.partner(h) != HalfEdgeMesh::kFront) continue;
    ++front;
    const FrontEdge edge = ball_mesh.front_edge(h);
    if (edge.opposite != mesh.voxel(mesh.opposite(h))) return "a front edge with another third vertex" + at(edge.from);
    for (const Vec3i& v : {edge.from, edge.to, edge.opposite})
      if (std::abs(glm::length(Vec3(v) - edge.ball) - kBallRadius) > 1e-9) return "a ball that does not touch its triangle" + at(v);
    if (!is_empty_ball(bone, edge.ball)) return "a front edge whose ball is not empty" + at(edge.from);
  }
  for (const auto& [vertex, sum] : balance)
    if (sum != 0) return "a front that is no loop" + at(mesh.voxel(vertex));
  if (front != mesh.front_edges()) return "a wrong number of front edges";
  if (used.size() != mesh.vertices()) return "a wrong number of vertices";
  for (const Vec3i& v : bone.solid_voxels()) {
    using State = HalfEdgeMesh::VertexState;
    const auto vertex = used.find({v.z, v.y, v.x});
    const State expected = vertex == used.end() ? State::orphan : open.contains(vertex->second) ? State::front : State::inner;
    if (ball_mesh.state(v) != expected) return "a wrong state of a vertex" + at(v);
  }
  return {};
}

namespace {

/// Whether the solid voxels round an edge of more than two triangles explain `triangles` of them.
bool is_explained(const MeshBone& bone, const std::array<Vec3i, 2>& edge, int triangles) {
  const Vec3i way = edge[1] - edge[0];
  const auto solid = [&](const Vec3i& v) { return bone.is_solid(v); };
  if (way.x != 0 && way.y != 0 && way.z != 0) {  // within one cell: a flat rectangle, cut along the edge
    int corners = 0;
    for_each_voxel({glm::min(edge[0], edge[1]), glm::max(edge[0], edge[1]) + 1}, [&](const Vec3i& v) { corners += solid(v) ? 1 : 0; });
    return corners == 4;
  }
  const int zero = way.x == 0 ? 0 : way.y == 0 ? 1 : 2;
  if (way[(zero + 1) % 3] != 0 &&
      way[(zero + 2) % 3] != 0) {  // diagonal of a face: a gap on both sides of it in the face, or a flat square
    Vec3i p = edge[0], up(0);
    p[(zero + 1) % 3] += way[(zero + 1) % 3];
    const Vec3i q = edge[0] + edge[1] - p;
    up[zero] = 1;
    bool flat = true;
    for (const Vec3i& v : {edge[0], edge[1], p, q}) flat = flat && !solid(v + up) && !solid(v - up);
    return (!solid(p) && !solid(q)) || (solid(p) && solid(q) && flat);
  }
  // Edge of one voxel: four cells share it. Each gap between the solid ones of the eight places round it is bounded by two triangles.
  const int axis = way.x != 0 ? 0 : way.y != 0 ? 1 : 2;
  static constexpr int kRing[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  std::array<bool, 8> ring{};
  for (std::size_t n = 0; n < 8; ++n) {
    Vec3i step(0);
    step[(axis + 1) % 3] = kRing[n][0];
    step[(axis + 2) % 3] = kRing[n][1];
    ring[n] = solid(edge[0] + step) || solid(edge[1] + step);
  }
  int gaps = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    const std::size_t cell = n / 2 * 2;
    const bool filled = (ring[n] && ring[(n + 1) % 8]) || (ring[cell] && ring[(cell + 2) % 8]);
    gaps += ring[n] && !filled ? 1 : 0;
  }
  return gaps > 1 && triangles == 2 * gaps;
}

std::string shared_edge_error(const BallMesh& mesh, const MeshBone& bone, const MeshCensus& census) {
  std::map<std::array<std::array<int, 3>, 2>, int> triangles;
  for (const PlainTriangle& t : triangles_of(mesh))
    for (std::size_t n = 0; n < 3; ++n) ++triangles[{std::min(t[n], t[(n + 1) % 3]), std::max(t[n], t[(n + 1) % 3])}];
  std::vector<std::array<Vec3i, 2>> shared;
  for (const auto& [ends, count] : triangles) {
    if (count % 2 != 0) return "an edge with an odd number of triangles";
    if (count == 2) continue;
    const auto voxel = [](const std::array<int, 3>& v) { return Vec3i(v[2], v[1], v[0]); };
    shared.push_back({voxel(ends[0]), voxel(ends[1])});
    if (!is_explained(bone, shared.back(), count)) return "a shared edge without a reason" + at(shared.back()[0]);
  }
  return shared == census.shared_edges ? std::string() : "an edge of more than two triangles that is not listed, or another one";
}

std::string orphan_error(const BallMesh& mesh, const MeshBone& bone) {
  std::set<std::tuple<int, int, int>> listed;
  for (const OrphanVoxel& orphan : find_orphans(mesh)) listed.insert({orphan.voxel.x, orphan.voxel.y, orphan.voxel.z});
  std::size_t orphans = 0;
  for (const Vec3i& v : bone.surface_voxels()) {
    if (mesh.state(v) != HalfEdgeMesh::VertexState::orphan) continue;
    ++orphans;
    if (!listed.contains({v.x, v.y, v.z})) return "an orphan that is not listed" + at(v);
    for (const Vec3i& side : {Vec3i(-1, -1, -1), Vec3i(1, -1, -1), Vec3i(-1, 1, -1), Vec3i(1, 1, -1), Vec3i(-1, -1, 1), Vec3i(1, -1, 1),
                              Vec3i(-1, 1, 1), Vec3i(1, 1, 1)}) {
      const bool faces =
          bone.is_solid(v + Vec3i(side.x, 0, 0)) && bone.is_solid(v + Vec3i(0, side.y, 0)) && bone.is_solid(v + Vec3i(0, 0, side.z));
      int solid = 0;
      for (unsigned n = 0; n < 8; ++n) solid += bone.is_solid(v + side * cell_corner(n)) ? 1 : 0;
      if (!faces && solid > 2) return "an orphan without a reason" + at(v);
    }
  }
  return orphans == listed.size() ? std::string() : "a listed orphan that is none";
}

}  // namespace

std::string mesh_error_of(const BallMesh& mesh, const MeshBone& bone) {
  if (std::string error = front_error(mesh, bone); !error.empty()) return error;
  const MeshCensus census = take_census(mesh);
  if (census.open_edges != 0 || mesh.half_edges().front_edges() != 0 || mesh.half_edges().border_edges() != 0)
    return std::to_string(census.open_edges) + " open edges";
  const MeshCheck check = check_mesh(at_centres(mesh.half_edges()));
  if (check.degenerate != 0 || check.open_edges != 0) return "core/tool finds a degenerate triangle or an open edge";
  if (check.flipped_edges != 0) return "core/tool finds an edge with both triangles in one direction";
  if (check.non_manifold_edges != census.shared_edges.size()) return "core/tool finds another number of shared edges";
  if ((census.corners + census.triangles - census.edges) % 2 != 0) return "an odd Euler number";
  if (std::string error = shared_edge_error(mesh, bone, census); !error.empty()) return error;
  return orphan_error(mesh, bone);
}

std::string twin_error(const BallMesh& mesh, const MeshBone& bone) {
  const PlainTriangles expected = twin_triangles(bone), found = triangles_of(mesh);
  if (found.size() != mesh.half_edges().triangles()) return "a triangle twice";
  if (found != expected)
    return "other triangles than the twin: " + std::to_string(found.size()) + " instead of " + std::to_string(expected.size());
  const PlainTopology plain = twin_topology(expected);
  const MeshCensus census = take_census(mesh);
  if (plain.unpaired != 0) return "the twin has an open edge";
  if (census.edges != plain.edges || census.corners != plain.corners || census.parts != plain.parts)
    return "other topology than the twin: " + std::to_string(census.corners) + " corners and " + std::to_string(census.parts) +
           " parts instead of " + std::to_string(plain.corners) + " and " + std::to_string(plain.parts);
  return {};
}

MovedTriangles moved_triangles(const BallMesh& mesh) {
  MovedTriangles out;
  const HalfEdgeMesh& half_edges = mesh.half_edges();
  for (Id t = 0; t < half_edges.triangle_slots(); ++t) {
    if (!half_edges.has_triangle(t)) continue;
    const auto voxel = [&](Id n) { return half_edges.voxel(half_edges.origin(3 * t + n)); };
    const PlainTriangle triangle = plain_triangle(voxel(0), voxel(1), voxel(2));
    for (Id n = 0; n < 3; ++n) {
      const Vec3i v = voxel(n);
      const Vec3f offset = mesh.offset(3 * t + n);
      for (std::size_t m = 0; m < 3; ++m)
        if (triangle[m] == std::array{v.z, v.y, v.x}) out[triangle][m] = {offset.x, offset.y, offset.z};
    }
  }
  return out;
}

}  // namespace burrhole::test
