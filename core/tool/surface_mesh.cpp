#include "core/tool/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "core/tool/join_rounded.h"
#include "core/tool/mesh_slices.h"

namespace burrhole {
namespace {

using Id = std::uint32_t;
constexpr Id kNone = std::numeric_limits<Id>::max();
constexpr double kRounding = 0x1p-22;  // [-] four roundings of a 32-bit float

bool lexicographic(const Vec3& a, const Vec3& b) noexcept {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// For each vertex, the first vertex at the same position.
std::vector<Id> first_at_place(std::span<const Vec3> positions) {
  std::vector<Id> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), Id{0});
  std::sort(order.begin(), order.end(), [&](Id a, Id b) {
    if (lexicographic(positions[a], positions[b])) return true;
    return !lexicographic(positions[b], positions[a]) && a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

struct Triangle {
  Id a, b, c;
};

/// Triangles by merged vertex, without those with fewer than three distinct vertices. Thin ones with three vertices connect neighbours and
/// stay.
std::vector<Triangle> whole_triangles(const SurfaceMesh& mesh, std::span<const Id> first) {
  std::vector<Triangle> out;
  out.reserve(mesh.indices.size() / 3);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Triangle t{first[mesh.indices[i]], first[mesh.indices[i + 1]], first[mesh.indices[i + 2]]};
    if (t.a != t.b && t.b != t.c && t.c != t.a) out.push_back(t);
  }
  return out;
}

struct Edge {
  Id low, high;
  bool rising;  ///< its triangle traverses it from low to high
};

std::vector<Edge> sorted_edges(std::span<const Triangle> triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  const auto add = [&](Id from, Id to) { edges.push_back({std::min(from, to), std::max(from, to), from < to}); };
  for (const Triangle& t : triangles) {
    add(t.a, t.b);
    add(t.b, t.c);
    add(t.c, t.a);
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  return edges;
}

/// Counts edges by the number of triangles that share them. @returns the open ones.
std::vector<Edge> count_edges(std::span<const Edge> edges, MeshCheck& check) {
  std::vector<Edge> open;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i == 1) open.push_back(edges[i]);
    if (end - i == 2 && edges[i].rising == edges[i + 1].rising) ++check.flipped_edges;
    if (end - i > 2) ++check.non_manifold_edges;
    i = end;
  }
  check.open_edges = open.size();
  return open;
}

/// Positions of which each is farther than a tolerance from all others, in a hash table of cells of that edge.
class DistinctPlaces {
 public:
  DistinctPlaces(std::size_t most, double tolerance) : tolerance_(tolerance), first_(std::bit_ceil(most + 1), kNone) {}

  /// @returns a known position within the tolerance, else adds this one.
  std::optional<Vec3> known_or_add(const Vec3& p) {
    const Vec3 cell = glm::floor(p / tolerance_);
    for (int n = 0; n < 27; ++n)
      for (Id i = first_[bucket(cell + Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1))]; i != kNone; i = places_[i].next)
        if (glm::distance(places_[i].position, p) <= tolerance_) return places_[i].position;
    Id& first = first_[bucket(cell)];
    places_.push_back({p, first});
    first = static_cast<Id>(places_.size() - 1);
    return std::nullopt;
  }

 private:
  struct Place {
    Vec3 position;
    Id next;  // of the same bucket
  };
  [[nodiscard]] std::size_t bucket(const Vec3& cell) const noexcept {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash = (hash ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis]))) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return hash & (first_.size() - 1);
  }

  double tolerance_;
  std::vector<Id> first_;
  std::vector<Place> places_;
};

/// Follows open edges from vertex to vertex until each chain closes or ends.
void measure_holes(std::span<const Edge> open, std::span<const Vec3> positions, MeshCheck& check) {
  struct Step {
    Id from, to;
    std::size_t edge;
  };
  std::vector<Step> steps;  // both directions, so that a chain is followed for any winding of the triangles
  for (std::size_t i = 0; i < open.size(); ++i) {
    steps.push_back({open[i].low, open[i].high, i});
    steps.push_back({open[i].high, open[i].low, i});
  }
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.from != b.from ? a.from < b.from : a.edge < b.edge; });
  std::vector<char> used(open.size(), 0);
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (used[i]) continue;
    used[i] = 1;
    double length = glm::distance(positions[open[i].low], positions[open[i].high]);
    for (Id at = open[i].high; at != open[i].low;) {
      auto step = std::lower_bound(steps.begin(), steps.end(), at, [](const Step& s, Id id) { return s.from < id; });
      while (step != steps.end() && step->from == at && used[step->edge]) ++step;
      if (step == steps.end() || step->from != at) break;
      used[step->edge] = 1;
      length += glm::distance(positions[at], positions[step->to]);
      at = step->to;
    }
    ++check.holes;
    check.longest_hole = std::max(check.longest_hole, length);
  }
}

/// Connected parts with their signed volumes and the vertex with the smallest x.
struct Parts {
  std::vector<double> volume;
  std::vector<Vec3> leftmost;
};

Parts find_parts(std::span<const Triangle> triangles, std::span<const Vec3> positions) {
  std::vector<Id> parent(positions.size());
  std::iota(parent.begin(), parent.end(), Id{0});
  const auto root = [&](Id v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : triangles) {
    const Id a = root(t.a);
    parent[root(t.b)] = a;
    parent[root(t.c)] = a;
  }
  Parts parts;
  std::vector<Id> number(positions.size(), kNone);
  for (const Triangle& t : triangles) {
    const Id r = root(t.a);
    if (number[r] == kNone) {
      number[r] = static_cast<Id>(parts.volume.size());
      parts.volume.push_back(0.0);
      parts.leftmost.push_back(positions[t.a]);
    }
    const Id n = number[r];
    // Relative to a vertex of the part, not to the origin: a small part far from the origin keeps its precision.
    const Vec3& o = positions[r];
    parts.volume[n] += glm::dot(positions[t.a] - o, glm::cross(positions[t.b] - o, positions[t.c] - o)) / 6.0;
    for (const Id v : {t.a, t.b, t.c})
      if (positions[v].x < parts.leftmost[n].x) parts.leftmost[n] = positions[v];
  }
  return parts;
}

std::optional<std::string> index_error(const SurfaceMesh& mesh) {
  if (mesh.indices.empty()) return "no triangles";
  if (mesh.indices.size() % 3 != 0) return "an index list whose length is not a multiple of three";
  for (const Id i : mesh.indices)
    if (i >= mesh.positions.size()) return fmt::format("index {} into {} vertices", i, mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    if (!is_finite(p)) return "a vertex that is not finite";
  return std::nullopt;
}

std::optional<std::string> edge_error(const MeshCheck& check) {
  if (check.open_edges > 0)
    return fmt::format("open: {} edges without a neighbour in {} hole{}, the longest {:.3g} mm around; close them in a mesh editor",
                       check.open_edges, check.holes, check.holes == 1 ? "" : "s", check.longest_hole * 1e3);
  if (check.non_manifold_edges > 0)
    return fmt::format("not a solid: {} edges are shared by more than two triangles; delete doubled faces and part bodies that touch there",
                       check.non_manifold_edges);
  if (check.flipped_edges > 0)
    return fmt::format("wound both ways: the triangles at {} edges do not agree on which side is outside; turn all normals outwards",
                       check.flipped_edges);
  return std::nullopt;
}

/// A part with inward orientation is a cavity if solid surrounds it: the point to the left of its leftmost vertex must be inside.
std::optional<std::string> part_error(const SurfaceMesh& mesh, const Parts& parts) {
  std::vector<Vec3> points;
  std::vector<std::size_t> which;
  for (std::size_t n = 0; n < parts.volume.size(); ++n)
    if (parts.volume[n] < 0.0) {
      points.push_back(parts.leftmost[n]);
      which.push_back(n);
    }
  const std::vector<int> around = windings_left_of(mesh, points);
  std::size_t astray = 0;
  double first_volume = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n)
    if (around[n] < 1 && astray++ == 0) first_volume = parts.volume[which[n]];
  if (astray == 0) return std::nullopt;
  return fmt::format(
      "inside-out in {} of {} parts: normals point inwards; flip them (the first has a signed volume of {:.3g} cm3 and no solid round it)",
      astray, parts.volume.size(), first_volume * 1e6);
}

}  // namespace

SurfaceMesh weld(const SurfaceMesh& mesh) {
  const std::vector<Id> first = first_at_place(mesh.positions);
  std::vector<Id> renamed(mesh.positions.size(), kNone);
  SurfaceMesh out;
  out.indices.reserve(mesh.indices.size());
  for (const Id i : mesh.indices) {
    Id& name = renamed[first[i]];
    if (name == kNone) {
      name = static_cast<Id>(out.positions.size());
      out.positions.push_back(mesh.positions[first[i]]);
    }
    out.indices.push_back(name);
  }
  return out;
}

std::string RoundingJoin::text() const {
  return fmt::format("{} {} within {:.2g} mm of another, a rounding of 32-bit coordinates: joined", joined,
                     joined == 1 ? "vertex of an open edge lies" : "vertices of open edges lie", tolerance * 1e3);
}

RoundingJoin join_rounded(SurfaceMesh& mesh) {
  const std::vector<Id> first = first_at_place(mesh.positions);
  const std::vector<Triangle> triangles = whole_triangles(mesh, first);
  MeshCheck ignored;
  const std::vector<Edge> open = count_edges(sorted_edges(triangles), ignored);
  RoundingJoin out;
  if (open.empty()) return out;
  for (const Vec3& p : mesh.positions) out.tolerance = std::max({out.tolerance, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  out.tolerance *= kRounding;
  if (!(out.tolerance > 0.0)) return out;
  std::vector<Id> border;
  for (const Edge& edge : open) border.insert(border.end(), {edge.low, edge.high});
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  DistinctPlaces places(border.size(), out.tolerance);
  std::vector<std::optional<Vec3>> moved(mesh.positions.size());
  for (const Id v : border)
    if ((moved[v] = places.known_or_add(mesh.positions[v]))) ++out.joined;
  if (out.joined == 0) return out;
  for (Id v = 0; v < mesh.positions.size(); ++v)
    if (const auto& to = moved[first[v]]) mesh.positions[v] = *to;
  mesh = weld(mesh);
  return out;
}

MeshCheck check_mesh(const SurfaceMesh& mesh) {
  const std::vector<Id> first = first_at_place(mesh.positions);
  const std::vector<Triangle> triangles = whole_triangles(mesh, first);
  MeshCheck check;
  check.triangles = mesh.indices.size() / 3;
  check.degenerate = check.triangles - triangles.size();
  measure_holes(count_edges(sorted_edges(triangles), check), mesh.positions, check);
  const Parts parts = find_parts(triangles, mesh.positions);
  check.parts = parts.volume.size();
  for (const double volume : parts.volume) check.volume += volume;
  return check;
}

std::optional<std::string> mesh_error(const SurfaceMesh& mesh) {
  if (auto error = index_error(mesh)) return error;
  const MeshCheck check = check_mesh(mesh);
  if (auto error = edge_error(check)) return error;
  if (check.volume < 0.0)
    return fmt::format("inside-out: its normals point inwards; flip them (signed volume {:.3g} cm3)", check.volume * 1e6);
  if (!(check.volume > 0.0)) return "flat: it encloses no volume; give a closed surface";
  const std::vector<Id> first = first_at_place(mesh.positions);
  return part_error(mesh, find_parts(whole_triangles(mesh, first), mesh.positions));
}

}  // namespace burrhole
