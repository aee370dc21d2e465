#include "core/mesh/ball_tables.h"

#include <numbers>

#include "core/base/assert.h"

namespace burrhole {
namespace {

// [voxel], [rad] Equal places differ by rounding; different ones by more than a hundredth, which ball_tables_test.cpp checks.
constexpr double kSame = 1e-6;

bool lower(const Vec3i& a, const Vec3i& b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; }

/// @returns the two ends of the diagonal along which a rectangle is cut. @param corners in any order.
std::array<Vec3i, 2> diagonal_of(const std::array<Vec3i, 4>& corners) {
  Vec3i lowest = corners[0];
  for (const Vec3i& corner : corners)
    if (lower(corner, lowest)) lowest = corner;
  Vec3i farthest = lowest;
  for (const Vec3i& corner : corners) {
    const Vec3i way = corner - lowest, best = farthest - lowest;
    if (way.x * way.x + way.y * way.y + way.z * way.z > best.x * best.x + best.y * best.y + best.z * best.z) farthest = corner;
  }
  return {lowest, farthest};
}

/// A centre that the ball may reach: where the ball then is, and how far it has rolled.
struct Reached {
  unsigned code = 0;
  double angle = 0.0;  // [rad]
};

/// @returns every centre that the ball on triangle (a, b, c) reaches when it rolls over the edge a b, by angle, then by code.
std::vector<Reached> reached_over(const Vec3i& edge, const Vec3i& opposite) {
  const Vec3 a(0.0), b(edge), middle = 0.5 * b, axis = glm::normalize(b);
  const auto start = ball_centre({a, b, Vec3(opposite)});
  std::vector<Reached> out;
  for (unsigned code = 0; start && code < 27; ++code) {
    const Vec3i hit = step_of_code(code);
    if (hit == Vec3i(0) || hit == edge || !share_cell(Vec3i(0), edge, hit)) continue;
    const auto centre = ball_centre({b, a, Vec3(hit)});
    if (!centre) continue;
    const Vec3 from = *start - middle, to = *centre - middle;
    double angle = std::atan2(glm::dot(axis, glm::cross(from, to)), glm::dot(from, to));
    if (angle < -kSame) angle += 2.0 * std::numbers::pi;
    out.push_back({code, angle});
  }
  std::ranges::sort(
      out, [](const Reached& x, const Reached& y) { return std::abs(x.angle - y.angle) > kSame ? x.angle < y.angle : x.code < y.code; });
  return out;
}

}  // namespace

std::optional<Vec3> ball_centre(const std::array<Vec3, 3>& points, double radius) {
  const Vec3 u = points[1] - points[0], v = points[2] - points[0], normal = glm::cross(u, v);
  const double square = glm::dot(normal, normal);
  if (!(square > 0.0)) return std::nullopt;
  const Vec3 across = (glm::dot(u, u) * glm::cross(v, normal) + glm::dot(v, v) * glm::cross(normal, u)) / (2.0 * square);
  const double height2 = radius * radius - glm::dot(across, across);
  if (!(height2 >= 0.0)) return std::nullopt;
  return points[0] + across + normal * std::sqrt(height2 / square);
}

bool CellTriangles::contains(const CellTriangle& triangle) const noexcept {
  for (unsigned n = 0; n < count; ++n)
    if (triangles[n] == triangle) return true;
  return false;
}

BallTables::BallTables(TieRule rule) : paths_(27 * 27) {
  for (unsigned edge = 0; edge < 27; ++edge)
    for (unsigned opposite = 0; opposite < 27; ++opposite) {
      const Vec3i b = step_of_code(edge), c = step_of_code(opposite);
      if (b != Vec3i(0) && c != Vec3i(0) && b != c && share_cell(Vec3i(0), b, c)) make_path(edge, opposite, rule);
    }
  for (unsigned corners = 0; corners < 256; ++corners) make_cell(corners);
}

void BallTables::make_path(unsigned edge, unsigned opposite, TieRule rule) {
  PivotPath& path = paths_[edge * 27 + opposite];
  const Vec3i a(0), b = step_of_code(edge);
  double last = -1.0;
  for (const Reached& reached : reached_over(b, step_of_code(opposite))) {
    const auto code = static_cast<std::uint8_t>(reached.code);
    if (reached.angle - last > kSame) {
      BH_ASSERT(path.count < path.stops.size());
      path.stops[path.count++] = {code, code, code};
      last = reached.angle;
      continue;
    }
    PivotStop& stop = path.stops[path.count - 1u];
    BH_ASSERT(stop.tied == stop.hit);  // a ball touches four centres at most
    stop.tied = code;
    const Vec3i first = step_of_code(stop.hit);
    const auto ends = diagonal_of({a, b, first, step_of_code(code)});
    const bool first_on_diagonal = ends[0] == first || ends[1] == first;
    stop.chosen = rule == TieRule::first_found || first_on_diagonal ? stop.hit : stop.tied;
  }
}

void BallTables::make_cell(unsigned corners) {
  CellTriangles& cell = cells_[corners];
  const auto solid = [&](unsigned n) { return (corners >> n & 1u) != 0; };
  for (unsigned a = 0; a < 8; ++a)
    for (unsigned b = a + 1; b < 8; ++b)
      for (unsigned c = a + 1; c < 8; ++c) {
        if (b == c || !solid(a) || !solid(b) || !solid(c)) continue;
        const std::array<Vec3i, 3> places{cell_corner(a), cell_corner(b), cell_corner(c)};
        const auto centre = ball_centre({Vec3(places[0]), Vec3(places[1]), Vec3(places[2])});
        if (!centre || glm::any(glm::lessThan(*centre, Vec3(0.0))) || glm::any(glm::greaterThan(*centre, Vec3(1.0)))) continue;
        bool empty = true, cut = true;
        for (unsigned n = 0; n < 8; ++n) {
          if (!solid(n) || n == a || n == b || n == c) continue;
          const double distance = glm::length(Vec3(cell_corner(n)) - *centre);
          empty = empty && distance > kBallRadius - kSame;
          if (std::abs(distance - kBallRadius) > kSame) continue;
          for (const Vec3i& end : diagonal_of({places[0], places[1], places[2], cell_corner(n)}))
            cut = cut && std::ranges::find(places, end) != places.end();
        }
        if (!empty || !cut) continue;
        BH_ASSERT(cell.count < cell.triangles.size());
        cell.triangles[cell.count++] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(c)};
      }
}

}  // namespace burrhole
