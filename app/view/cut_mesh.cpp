#include "app/view/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace burrhole {
namespace {

constexpr double kThinnest = 1e-9;  // [m] of a strip of the section
constexpr int kPlaces = 96;         // along a strip, at which its part is found; a narrower part may be missed
constexpr int kHalvings = 20;       // of a place where two parts meet

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

void append(TriangleMesh& out, const Vec3& position, const Vec3& normal, double size = 1.0) {
  out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
  out.positions.emplace_back(position);
  const double length = glm::length(normal);
  out.normals.emplace_back((length > 0.0 ? normal / length : Vec3(0.0, 0.0, 1.0)) * size);
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
/// the lines to its left wind about it, so that surfaces that overlap count once. @param heights [m] at which strips end besides.
template <class Fill>
void fill_section(const std::vector<Line>& lines, std::vector<double> heights, Fill&& fill) {
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

/// Coordinates of the plane; in all but a plane across z, lines of equal v have equal z.
struct PlaneAxes {
  Vec3 right, up;  // right x up = normal
};

PlaneAxes axes_of(const Vec3& normal) {
  const Vec3 rise = Vec3(0.0, 0.0, 1.0) - normal * normal.z;
  const Vec3 up = glm::length(rise) > 1e-3 ? glm::normalize(rise) : glm::normalize(Vec3(0.0, 1.0, 0.0) - normal * normal.y);
  return {glm::cross(up, normal), up};
}

/// End of a part of a trapezoid, as a share 0..1 of its width.
struct PartEnd {
  double share;
  bool cuts;
};

/// @param at(share) is the place at half the trapezoid's height. @returns the parts from left to right; the last one ends at 1.
template <class At>
std::vector<PartEnd> find_parts(const SectionParts& parts, const At& at) {
  std::vector<PartEnd> out;
  const auto share_of = [](int n) { return (n + 0.5) / kPlaces; };
  bool now = parts.cuts(at(share_of(0)));
  for (int n = 1; n < kPlaces; ++n) {
    if (parts.cuts(at(share_of(n))) == now) continue;
    double from = share_of(n - 1), to = share_of(n);
    for (int i = 0; i < kHalvings; ++i) (parts.cuts(at(0.5 * (from + to))) == now ? from : to) = 0.5 * (from + to);
    out.push_back({0.5 * (from + to), now});
    now = !now;
  }
  out.push_back({1.0, now});
  return out;
}

/// Appends the section inside the lines.
void append_section(const std::vector<Line>& lines, const PlaneAxes& axes, const Vec3& normal, double offset, const SectionParts* parts,
                    TriangleMesh& out) {
  const Vec3 origin = offset * normal;
  std::vector<double> heights;
  if (parts != nullptr && axes.up.z > 1e-3)
    for (const double z : parts->heights) heights.push_back((z - origin.z) / axes.up.z);
  fill_section(lines, std::move(heights), [&](double low, double high, const Crossing& left, const Crossing& other) {
    const auto place = [&](double share, double t) {
      const double from = left.low + t * (left.high - left.low), to = other.low + t * (other.high - other.low);
      return origin + (from + share * (to - from)) * axes.right + (low + t * (high - low)) * axes.up;
    };
    std::vector<PartEnd> ends{{1.0, false}};
    if (parts != nullptr) ends = find_parts(*parts, [&](double share) { return place(share, 0.5); });
    double from = 0.0;
    for (const auto& [to, cuts] : ends) {
      const Vec3 a = place(from, 0.0), b = place(to, 0.0), c = place(to, 1.0), d = place(from, 1.0);
      for (const Vec3& p : {a, b, c, a, c, d}) append(out, p, normal, parts == nullptr ? 1.0 : cuts ? kSectionCuts : kSectionBody);
      from = to;
    }
  });
}

}  // namespace

TriangleMesh cut_mesh(const TriangleMesh& mesh, const Vec3& normal, double offset, const SectionParts* parts) {
  const PlaneAxes axes = axes_of(normal);
  TriangleMesh out;
  std::vector<Line> lines;
  const auto flat = [&](const Vec3& p) { return glm::dvec2(glm::dot(p, axes.right), glm::dot(p, axes.up)); };
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    std::array<Corner, 3> triangle;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t at = mesh.indices[t + n];
      const Vec3 position(mesh.positions[at]);
      triangle[n] = {position, Vec3(mesh.normals[at]), glm::dot(normal, position) - offset};
    }
    if (const auto edge = append_below(triangle, out)) lines.push_back({flat(edge->first), flat(edge->second)});
  }
  append_section(lines, axes, normal, offset, parts, out);
  return out;
}

}  // namespace burrhole
