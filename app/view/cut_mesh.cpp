#include "app/view/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {
namespace {

constexpr double kThinnest = 1e-9;  // [m] of a strip of the section

struct Corner {
  Vec3 position, normal;
  double above;  // [m] the plane
};

/// A line of the section, in the plane's coordinates: material is on its left.
struct Line {
  glm::dvec2 from, to;  // [m]
};

Corner between(const Corner& a, const Corner& b) {
  const double t = a.above / (a.above - b.above);
  return {a.position + t * (b.position - a.position), a.normal + t * (b.normal - a.normal), 0.0};
}

void append(TriangleMesh& out, const Vec3& position, const Vec3& normal) {
  out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
  out.positions.emplace_back(position);
  const double length = glm::length(normal);
  out.normals.emplace_back(length > 0.0 ? normal / length : Vec3(0.0, 0.0, 1.0));
}

/// Appends the part of a triangle below the plane. @returns the edge that lies in the plane, in the triangle's sense of rotation.
std::optional<std::pair<Vec3, Vec3>> append_below(const std::array<Corner, 3>& triangle, TriangleMesh& out) {
  std::vector<Corner> kept;
  std::optional<Vec3> leaves, enters;
  for (std::size_t n = 0; n < 3; ++n) {
    const Corner &a = triangle[n], &b = triangle[(n + 1) % 3];
    if (a.above <= 0.0) kept.push_back(a);
    if ((a.above <= 0.0) == (b.above <= 0.0)) continue;
    kept.push_back(between(a, b));
    (a.above <= 0.0 ? leaves : enters) = kept.back().position;
  }
  for (std::size_t n = 2; n < kept.size(); ++n)
    for (const Corner* corner : {&kept[0], &kept[n - 1], &kept[n]}) append(out, corner->position, corner->normal);
  if (!leaves || !enters) return std::nullopt;
  return std::pair{*leaves, *enters};
}

/// A line where it crosses a strip of the section.
struct Crossing {
  double low, high;  // [m] u at the lower and at the upper edge of the strip
  int winding;
};

/// Fills the section strip by strip, between the heights of the ends of lines: there the lines are sides of trapezoids. A place is inside where
/// the lines to its left wind about it, so that surfaces that overlap count once.
template <class Fill>
void fill_section(const std::vector<Line>& lines, Fill&& fill) {
  std::vector<double> heights;
  for (const Line& line : lines) heights.insert(heights.end(), {line.from.y, line.to.y});
  std::ranges::sort(heights);
  std::vector<Crossing> crossings;
  for (std::size_t n = 1; n < heights.size(); ++n) {
    const double low = heights[n - 1], high = heights[n], middle = 0.5 * (low + high);
    if (high - low < kThinnest) continue;
    crossings.clear();
    for (const Line& line : lines) {
      const auto [from, to] = line;
      if ((from.y < middle) == (to.y < middle)) continue;
      const auto at = [&, from = from, to = to](double v) { return from.x + (v - from.y) / (to.y - from.y) * (to.x - from.x); };
      crossings.push_back({at(low), at(high), to.y > from.y ? 1 : -1});
    }
    std::ranges::sort(crossings, {}, [](const Crossing& c) { return c.low + c.high; });
    int winding = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
      winding += crossings[i].winding;
      if (winding != 0) fill(low, high, crossings[i], crossings[i + 1]);
    }
  }
}

}  // namespace

TriangleMesh cut_mesh(const TriangleMesh& mesh, const Vec3& normal, double offset) {
  const Quat turn = rotation_from_z(normal);
  const Vec3 right = turn * Vec3(1.0, 0.0, 0.0), up = turn * Vec3(0.0, 1.0, 0.0);
  TriangleMesh out;
  std::vector<Line> lines;
  const auto flat = [&](const Vec3& p) { return glm::dvec2(glm::dot(p, right), glm::dot(p, up)); };
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::array<Corner, 3> triangle;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t at = mesh.indices[t + n];
      const Vec3 position(mesh.positions[at]);
      triangle[n] = {position, Vec3(mesh.normals[at]), glm::dot(normal, position) - offset};
    }
    if (const auto edge = append_below(triangle, out)) lines.push_back({flat(edge->first), flat(edge->second)});
  }
  const Vec3 origin = offset * normal;
  fill_section(lines, [&](double low, double high, const Crossing& left, const Crossing& other) {
    const auto place = [&](double u, double v) { return origin + u * right + v * up; };
    const Vec3 a = place(left.low, low), b = place(other.low, low), c = place(other.high, high), d = place(left.high, high);
    for (const Vec3& p : {a, b, c, a, c, d}) append(out, p, normal);
  });
  return out;
}

}  // namespace burrhole
