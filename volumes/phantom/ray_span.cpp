#include "volumes/phantom/ray_span.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

constexpr RaySpan kNothing{0.0, 0.0};

/// Keeps t between (-b - sqrt(discriminant)) / a and (-b + sqrt(discriminant)) / a, a > 0; nothing if there is no root.
RaySpan clip_between_roots(RaySpan span, double a, double b, double discriminant) noexcept {
  if (!(discriminant > 0.0)) return kNothing;
  const double root = std::sqrt(discriminant);
  return {std::max(span.enter, (-b - root) / a), std::min(span.exit, (-b + root) / a)};
}

}  // namespace

RaySpan clip_half_space(RaySpan span, const Ray& ray, const Vec3& normal, double offset) noexcept {
  const double along = glm::dot(normal, ray.direction);
  const double room = offset - glm::dot(normal, ray.origin);
  if (along > 0.0) {
    span.exit = std::min(span.exit, room / along);
  } else if (along < 0.0) {
    span.enter = std::max(span.enter, room / along);
  } else if (room < 0.0) {
    return kNothing;
  }
  return span;
}

RaySpan clip_box(RaySpan span, const Ray& ray, const Vec3& lo, const Vec3& hi) noexcept {
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 axis(0.0);
    axis[a] = 1.0;
    span = clip_half_space(clip_half_space(span, ray, axis, hi[a]), ray, -axis, -lo[a]);
  }
  return span;
}

RaySpan clip_ball(RaySpan span, const Ray& ray, const Vec3& centre, double radius) noexcept {
  const Vec3 from_centre = ray.origin - centre;
  const double b = glm::dot(from_centre, ray.direction);
  // Squared distance of the line from the centre: better conditioned for distant origins than |o - c|^2 - b^2.
  const Vec3 miss = from_centre - b * ray.direction;
  const double half_chord_squared = radius * radius - glm::dot(miss, miss);
  return clip_between_roots(span, 1.0, b, half_chord_squared);
}

RaySpan clip_cylinder(RaySpan span, const Ray& ray, double radius) noexcept {
  const double a = ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y;
  const double c = ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y - radius * radius;
  if (a <= 0.0) return c <= 0.0 ? span : kNothing;
  const double b = ray.origin.x * ray.direction.x + ray.origin.y * ray.direction.y;
  return clip_between_roots(span, a, b, b * b - a * c);
}

RaySpans subtract(const RaySpan& from, const RaySpan& hole) noexcept {
  if (from.empty()) return {};
  if (hole.empty()) return {from, kNothing};
  const RaySpan before{from.enter, std::min(from.exit, hole.enter)};
  const RaySpan after{std::max(from.enter, hole.exit), from.exit};
  if (before.empty()) return {after.empty() ? kNothing : after, kNothing};
  return {before, after.empty() ? kNothing : after};
}

}  // namespace burrhole
