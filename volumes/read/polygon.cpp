#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "volumes/read/mesh_formats.h"

namespace burrhole {
namespace {

using Point = glm::dvec2;

/// Twice the signed area of a, b, c.
double turn(const Point& a, const Point& b, const Point& c) noexcept { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// The corners projected on the coordinate plane with the largest area (Newell's normal), counter-clockwise.
std::vector<Point> flatten(std::span<const std::uint32_t> corners, const SurfaceMesh& mesh) {
  Vec3 normal(0.0);
  const Vec3 origin = mesh.positions[corners[0]];
  for (std::size_t n = 1; n + 1 < corners.size(); ++n)
    normal += glm::cross(mesh.positions[corners[n]] - origin, mesh.positions[corners[n + 1]] - origin);
  const Vec3 size = glm::abs(normal);
  const std::size_t drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
  const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
  std::vector<Point> flat;
  for (const std::uint32_t c : corners) flat.emplace_back(sign * (mesh.positions[c][u] - origin[u]), mesh.positions[c][v] - origin[v]);
  return flat;
}

/// The rest of the polygon during ear clipping.
struct Clipping {
  std::vector<Point> flat;
  std::vector<std::size_t> left;  ///< remaining corners, in order
  std::uint64_t& steps;           ///< corners tested

  [[nodiscard]] std::size_t at(std::size_t n) const { return left[n % left.size()]; }

  /// Whether corner n is convex and no other corner lies inside the triangle with its neighbours.
  [[nodiscard]] bool is_ear(std::size_t n) const {
    ++steps;
    const Point &a = flat[at(n + left.size() - 1)], &b = flat[at(n)], &c = flat[at(n + 1)];
    if (turn(a, b, c) <= 0.0) return false;
    for (const std::size_t other : left) {
      ++steps;
      const Point& p = flat[other];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  /// The next ear at or after corner n. Without any, the corner closest to convex: slivers and self-intersections have no ear.
  [[nodiscard]] std::size_t next_ear(std::size_t n) const {
    std::size_t best = n;
    double best_turn = -1e300;
    for (std::size_t step = 0; step < left.size(); ++step) {
      const std::size_t m = (n + step) % left.size();
      if (is_ear(m)) return m;
      const double t = turn(flat[at(m + left.size() - 1)], flat[at(m)], flat[at(m + 1)]);
      // A straight corner is clipped last: otherwise its neighbours would share an edge that passes it.
      if (t != 0.0 && t > best_turn) {
        best_turn = t;
        best = m;
      }
    }
    return best;
  }
};

}  // namespace

std::string append_polygon(std::span<const std::uint32_t> corners, SurfaceMesh& mesh, std::uint64_t& steps) {
  if (corners.size() == 3) {
    mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
    return {};
  }
  Clipping clipping{flatten(corners, mesh), {}, steps};
  for (std::size_t n = 0; n < corners.size(); ++n) clipping.left.push_back(n);
  for (std::size_t n = 0; clipping.left.size() > 3;) {
    if (steps > kMaxPolygonSteps)
      return fmt::format("its polygons of up to {} corners take more than {} steps to cut into triangles: cut them beforehand",
                         kMaxPolygonCorners, kMaxPolygonSteps);
    n = clipping.next_ear(n % clipping.left.size());
    for (const std::size_t m : {n + clipping.left.size() - 1, n, n + 1}) mesh.indices.push_back(corners[clipping.at(m)]);
    clipping.left.erase(clipping.left.begin() + static_cast<std::ptrdiff_t>(n));
  }
  for (const std::size_t m : clipping.left) mesh.indices.push_back(corners[m]);
  return {};
}

}  // namespace burrhole
