#include "tests/core/mesh/pivot_twin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace burrhole::test {
namespace {

constexpr double kSame = 1e-7;

Vec3 place(const std::array<int, 3>& v) { return {v[2], v[1], v[0]}; }

/// The ball through three points on the side of their normal: three planes, solved as a linear system; then up to the radius.
std::optional<Vec3> resting_ball(const Vec3& a, const Vec3& b, const Vec3& c, double radius) {
  const Vec3 normal = glm::cross(b - a, c - a);
  if (glm::length(normal) < kSame) return std::nullopt;
  const Mat3 rows = glm::transpose(Mat3(b - a, c - a, normal));
  const Vec3 right(0.5 * (glm::dot(b, b) - glm::dot(a, a)), 0.5 * (glm::dot(c, c) - glm::dot(a, a)), glm::dot(normal, a));
  const Vec3 middle = glm::inverse(rows) * right;
  const double rest = radius * radius - glm::dot(middle - a, middle - a);
  if (rest < 0.0) return std::nullopt;
  return middle + std::sqrt(rest) * glm::normalize(normal);
}

/// Whether no solid centre lies in the ball and, of more than three on it, the three are cut by the tie rule.
bool rests(const MeshBone& bone, const std::array<Vec3i, 3>& corners, double radius) {
  const auto ball = resting_ball(Vec3(corners[0]), Vec3(corners[1]), Vec3(corners[2]), radius);
  if (!ball) return false;
  std::vector<std::array<int, 3>> touched;
  const Vec3i nearest(glm::round(*ball));
  for (int k = -2; k <= 2; ++k)
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) {
        const Vec3i v = nearest + Vec3i(i, j, k);
        if (!bone.is_solid(v)) continue;
        const double distance = glm::length(Vec3(v) - *ball);
        if (distance < radius - kSame) return false;
        if (distance < radius + kSame) touched.push_back({v.z, v.y, v.x});
      }
  if (touched.size() == 3) return true;
  const auto lowest = *std::ranges::min_element(touched);
  const auto farthest = *std::ranges::max_element(touched, {}, [&](const auto& v) { return glm::length(place(v) - place(lowest)); });
  const auto is_corner = [&](const std::array<int, 3>& v) {
    return std::ranges::any_of(corners, [&](const Vec3i& c) { return std::array{c.z, c.y, c.x} == v; });
  };
  return touched.size() == 4 && is_corner(lowest) && is_corner(farthest);
}

struct Classes {
  std::vector<std::size_t> parent;
  explicit Classes(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), std::size_t{0}); }
  std::size_t of(std::size_t n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  }
  void join(std::size_t a, std::size_t b) { parent[of(a)] = of(b); }
  std::size_t count() {
    std::size_t roots = 0;
    for (std::size_t n = 0; n < parent.size(); ++n) roots += parent[n] == n ? 1 : 0;
    return roots;
  }
};

}  // namespace

PlainTriangle plain_triangle(const Vec3i& a, const Vec3i& b, const Vec3i& c) {
  PlainTriangle out{{{a.z, a.y, a.x}, {b.z, b.y, b.x}, {c.z, c.y, c.x}}};
  std::ranges::rotate(out, std::ranges::min_element(out));
  return out;
}

PlainTriangles twin_triangles(const MeshBone& bone, double radius) {
  PlainTriangles out;
  for (const Vec3i& a : bone.surface_voxels()) {
    std::vector<Vec3i> near;
    for_each_voxel({a - 2, a + 3}, [&](const Vec3i& v) {
      if (v != a && bone.is_solid(v) && glm::length(Vec3(v - a)) <= 2.0 * radius) near.push_back(v);
    });
    for (const Vec3i& b : near)
      for (const Vec3i& c : near)
        if (b != c && glm::length(Vec3(b - c)) <= 2.0 * radius && rests(bone, {a, b, c}, radius)) out.insert(plain_triangle(a, b, c));
  }
  return out;
}

PlainTopology twin_topology(const PlainTriangles& triangles, double radius) {
  struct Side {
    std::size_t triangle;
    std::size_t corner;  // where it begins
    Vec3 ball;
  };
  std::map<std::pair<std::array<int, 3>, std::array<int, 3>>, std::vector<Side>> sides;
  std::size_t count = 0;
  for (const PlainTriangle& t : triangles) {
    const Vec3 ball = resting_ball(place(t[0]), place(t[1]), place(t[2]), radius).value();
    for (std::size_t n = 0; n < 3; ++n) sides[{t[n], t[(n + 1) % 3]}].push_back({count, n, ball});
    ++count;
  }
  Classes parts(count), corners(3 * count);
  PlainTopology out{.edges = 3 * count / 2};
  for (const auto& [ends, here] : sides) {
    const Vec3 from = place(ends.first), axis = glm::normalize(place(ends.second) - from), middle = 0.5 * (from + place(ends.second));
    const auto there = sides.find({ends.second, ends.first});
    for (const Side& side : here) {
      const Side* nearest = nullptr;
      double least = 10.0;
      for (std::size_t n = 0; there != sides.end() && n < there->second.size(); ++n) {
        const Vec3 u = side.ball - middle, v = there->second[n].ball - middle;
        double angle = std::atan2(glm::dot(axis, glm::cross(u, v)), glm::dot(u, v));
        if (angle < -kSame) angle += 2.0 * 3.14159265358979;
        if (angle < least) {
          least = angle;
          nearest = &there->second[n];
        }
      }
      if (nearest == nullptr) {
        ++out.unpaired;
        continue;
      }
      parts.join(side.triangle, nearest->triangle);
      corners.join(3 * side.triangle + side.corner, 3 * nearest->triangle + (nearest->corner + 1) % 3);
      corners.join(3 * side.triangle + (side.corner + 1) % 3, 3 * nearest->triangle + nearest->corner);
    }
  }
  out.parts = parts.count();
  out.corners = corners.count();
  return out;
}

PlainTriangles triangles_of(const BallMesh& mesh) {
  PlainTriangles out;
  const HalfEdgeMesh& half_edges = mesh.half_edges();
  for (HalfEdgeMesh::Id t = 0; t < half_edges.triangle_slots(); ++t)
    if (half_edges.has_triangle(t))
      out.insert(plain_triangle(half_edges.voxel(half_edges.origin(3 * t)), half_edges.voxel(half_edges.target(3 * t)),
                                half_edges.voxel(half_edges.opposite(3 * t))));
  return out;
}

}  // namespace burrhole::test
