/// volumes/phantom/ray_span.h: where a ray runs inside a convex solid, found by clipping with its faces one by one.
///   Frame  that of the caller.   Units  SI; positions along the ray in m from its origin (the direction has length 1).
///   Source own derivation: each face of a convex solid keeps an interval of the ray, so the solid keeps their intersection.
#pragma once

#include <limits>

#include "core/base/geometry.h"

namespace burrhole {

struct Ray {
  Vec3 origin{0.0};               ///< [m]
  Vec3 direction{0.0, 0.0, 1.0};  ///< length 1
};

/// Half line or part of it; empty if out <= in.
struct RaySpan {
  double in = 0.0;
  double out = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool empty() const noexcept { return !(out > in); }
};

/// Keeps the part where dot(normal, p) <= offset.
[[nodiscard]] RaySpan clip_half_space(RaySpan span, const Ray& ray, const Vec3& normal, double offset) noexcept;
/// Keeps the part inside the box lo..hi.
[[nodiscard]] RaySpan clip_box(RaySpan span, const Ray& ray, const Vec3& lo, const Vec3& hi) noexcept;
/// Keeps the part inside the ball.
[[nodiscard]] RaySpan clip_ball(RaySpan span, const Ray& ray, const Vec3& centre, double radius) noexcept;
/// Keeps the part inside the endless cylinder round the z axis.
[[nodiscard]] RaySpan clip_cylinder(RaySpan span, const Ray& ray, double radius) noexcept;

/// What is left of one interval when another is taken out: at most two, in order along the ray, empty ones last.
struct RaySpans {
  RaySpan first{0.0, 0.0};
  RaySpan second{0.0, 0.0};
};
[[nodiscard]] RaySpans subtract(const RaySpan& from, const RaySpan& hole) noexcept;

}  // namespace burrhole
