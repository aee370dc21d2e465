#include "volumes/phantom/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

using Vec2 = glm::dvec2;

/// [m] Below this distance the direction from an edge is dominated by rounding.
constexpr double kOnEdge = 1e-12;

/// Meridian half plane of a solid of revolution: x = distance from the z axis, y = z. The nearest surface point lies in the half plane of
/// p: rotating a point about the axis towards p never increases its distance. So the distance in 3D is the distance to a curve in 2D.
struct Meridian {
  Vec2 point;
  Vec2 radial;  ///< unit, from the axis to p; +x on the axis
  [[nodiscard]] Vec3 lift(const Vec2& v) const noexcept { return {v.x * radial.x, v.x * radial.y, v.y}; }
};

Meridian meridian_of(const Vec3& p) noexcept {
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  return {{rho, p.z}, rho > 0.0 ? Vec2(p.x, p.y) / rho : Vec2(1.0, 0.0)};
}

/// The nearest piece of the curve so far.
struct NearestPiece {
  double distance = std::numeric_limits<double>::infinity();
  Vec2 normal{0.0, 1.0};

  void offer(double piece_distance, const Vec2& piece_normal) noexcept {
    if (piece_distance >= distance) return;
    distance = piece_distance;
    normal = piece_normal;
  }
  /// Straight piece from a to b with its outward normal; `outside` states the side of p, for the direction from an end.
  void offer_segment(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& outward, bool outside) noexcept {
    const Vec2 ab = b - a;
    const double t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
    const Vec2 away = p - (a + t * ab);
    const double d = glm::length(away);
    const bool at_end = (t <= 0.0 || t >= 1.0) && d > kOnEdge;
    offer(d, at_end ? (outside ? away : -away) / d : outward);
  }
};

SurfaceDistance lifted(const NearestPiece& piece, const Meridian& at, bool outside) noexcept {
  return {outside ? piece.distance : -piece.distance, at.lift(piece.normal)};
}

}  // namespace

SurfaceDistance BoxShape::nearest(const Vec3& p) const noexcept {
  const Vec3 q = p - centre;
  const Vec3 side(q.x < 0.0 ? -1.0 : 1.0, q.y < 0.0 ? -1.0 : 1.0, q.z < 0.0 ? -1.0 : 1.0);
  const Vec3 beyond = q * side - half;  // positive along the axes on which p is outside
  const Vec3 out = glm::max(beyond, Vec3(0.0));
  const double d = glm::length(out);
  if (d > 0.0) return {d, side * out / d};
  // Inside, the nearest face is the one with the smallest distance.
  std::size_t face = 2;
  for (std::size_t a = 0; a < 2; ++a)
    if (beyond[a] > beyond[face]) face = a;
  Vec3 normal(0.0);
  normal[face] = side[face];
  return {beyond[face], normal};
}

RaySpans BoxShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  return subtract(clip_box(span, ray, centre - half, centre + half), {0.0, 0.0});
}

SurfaceDistance SlabShape::nearest(const Vec3& p) const noexcept {
  const double above = glm::dot(normal, p);
  const double below = -thickness - above;
  return above >= below ? SurfaceDistance{above, normal} : SurfaceDistance{below, -normal};
}

RaySpans SlabShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  return subtract(clip_half_space(clip_half_space(span, ray, normal, 0.0), ray, -normal, thickness), {0.0, 0.0});
}

SurfaceDistance BallShape::nearest(const Vec3& p) const noexcept {
  const Vec3 q = p - centre;
  const double r = glm::length(q);
  return {r - radius, r > 0.0 ? q / r : Vec3(0.0, 0.0, 1.0)};
}

RaySpans BallShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  return subtract(clip_ball(span, ray, centre, radius), {0.0, 0.0});
}

SurfaceDistance CapsuleShape::nearest(const Vec3& p) const noexcept {
  const Vec3 q(p.x - std::clamp(p.x, -half, half), p.y, p.z + radius);
  const double r = glm::length(q);
  return {r - radius, r > 0.0 ? q / r : Vec3(0.0, 0.0, 1.0)};
}

RaySpans CapsuleShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  // The solid is convex and the union of two balls and a cylinder, so its part of the ray reaches from the first to the last of theirs.
  const auto turned = [](const Vec3& v) { return Vec3(v.z, v.y, v.x); };  // the cylinder's axis becomes z
  const Ray upright{turned(ray.origin + Vec3(0.0, 0.0, radius)), turned(ray.direction)};
  const Vec3 up(0.0, 0.0, 1.0);
  const RaySpan parts[] = {clip_ball(span, ray, Vec3(-half, 0.0, -radius), radius), clip_ball(span, ray, Vec3(half, 0.0, -radius), radius),
                           clip_half_space(clip_half_space(clip_cylinder(span, upright, radius), upright, up, half), upright, -up, half)};
  RaySpan whole{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const RaySpan& part : parts) {
    if (part.empty()) continue;
    whole.enter = std::min(whole.enter, part.enter);
    whole.exit = std::max(whole.exit, part.exit);
  }
  return subtract(whole.empty() ? RaySpan{0.0, 0.0} : whole, {0.0, 0.0});
}

SurfaceDistance WedgeShape::nearest(const Vec3& p) const noexcept {
  // By symmetry fold to x >= 0. The face starts at the edge along (sine, -cosine); `down` is the position of the foot of p on it.
  const Vec2 q(std::abs(p.x), p.z);
  const double side = p.x < 0.0 ? -1.0 : 1.0;
  const double height = q.x * cosine + q.y * sine;
  const double down = q.x * sine - q.y * cosine;
  // Inside (height <= 0) the foot is always on the face, as the solid is convex; outside it may lie beyond the edge.
  const double r = glm::length(q);
  if (height > 0.0 && down < 0.0 && r > kOnEdge) return {r, Vec3(side * q.x, 0.0, q.y) / r};
  return {height, Vec3(side * cosine, 0.0, sine)};
}

RaySpans WedgeShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  const RaySpan left = clip_half_space(span, ray, Vec3(-cosine, 0.0, sine), 0.0);
  return subtract(clip_half_space(left, ray, Vec3(cosine, 0.0, sine), 0.0), {0.0, 0.0});
}

SurfaceDistance PitShape::nearest(const Vec3& p) const noexcept {
  const Meridian at = meridian_of(p);
  const Vec2& m = at.point;
  const bool in_hole = m.x < hole_radius && m.y > -hole_depth;
  const bool outside = in_hole || m.y > 0.0 || m.y < -thickness;
  NearestPiece piece;
  // The top face has no outer end: an end farther out than p gives the same result.
  const double far_out = 2.0 * std::max(m.x, hole_radius);
  piece.offer_segment(m, {hole_radius, 0.0}, {far_out, 0.0}, {0.0, 1.0}, outside);
  piece.offer_segment(m, {hole_radius, 0.0}, {hole_radius, -hole_depth}, {-1.0, 0.0}, outside);
  piece.offer_segment(m, {0.0, -hole_depth}, {hole_radius, -hole_depth}, {0.0, 1.0}, outside);
  piece.offer(std::abs(m.y + thickness), {0.0, -1.0});
  return lifted(piece, at, outside);
}

RaySpans PitShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  const Vec3 up(0.0, 0.0, 1.0);
  const RaySpan slab = clip_half_space(clip_half_space(span, ray, up, 0.0), ray, -up, thickness);
  return subtract(slab, clip_half_space(clip_cylinder({}, ray, hole_radius), ray, -up, hole_depth));
}

SurfaceDistance ShellShape::nearest(const Vec3& p) const noexcept {
  const Vec3 q = p + Vec3(0.0, 0.0, outer_radius);
  if (rim_radius > 0.0) return nearest_with_rim(q);
  const double r = glm::length(q);
  const Vec3 up = r > 0.0 ? q / r : Vec3(0.0, 0.0, 1.0);
  const double above = r - outer_radius;
  const double below = inner_radius - r;
  return above >= below ? SurfaceDistance{above, up} : SurfaceDistance{below, -up};
}

SurfaceDistance ShellShape::nearest_with_rim(const Vec3& q) const noexcept {
  // Meridian curve: the outer arc, the inner arc and the straight wall between their ends at x = rim_radius; origin at the centre of the
  // spheres.
  const Meridian at = meridian_of(q);
  const Vec2& m = at.point;
  const double r = glm::length(m);
  const Vec2 up = r > 0.0 ? m / r : Vec2(0.0, 1.0);
  const bool outside = r > outer_radius || r < inner_radius || m.x > rim_radius || m.y < 0.0;
  const Vec2 outer_end(rim_radius, std::sqrt(outer_radius * outer_radius - rim_radius * rim_radius));
  const Vec2 inner_end(rim_radius, std::sqrt(inner_radius * inner_radius - rim_radius * rim_radius));
  NearestPiece piece;
  // The foot on an arc lies on the line through the centre if that line meets the arc; otherwise it is an end, which also belongs to the
  // wall.
  const double reach = up.y > 0.0 ? up.x : 2.0;  // sine of the angle from the axis; 2: below the centre, no arc there
  if (reach * outer_radius <= rim_radius) piece.offer(std::abs(r - outer_radius), up);
  if (reach * inner_radius <= rim_radius) piece.offer(std::abs(r - inner_radius), -up);
  piece.offer_segment(m, outer_end, inner_end, {1.0, 0.0}, outside);
  return lifted(piece, at, outside);
}

RaySpans ShellShape::along(const Ray& ray, const RaySpan& span) const noexcept {
  const Vec3 centre(0.0, 0.0, -outer_radius);
  RaySpan solid = clip_ball(span, ray, centre, outer_radius);
  if (rim_radius > 0.0) solid = clip_half_space(clip_cylinder(solid, ray, rim_radius), ray, Vec3(0.0, 0.0, -1.0), outer_radius);
  return subtract(solid, clip_ball({}, ray, centre, inner_radius));
}

}  // namespace burrhole
