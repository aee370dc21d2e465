/// volumes/phantom/ray_span.h: the part of a ray inside a convex solid, by clipping with one face after another.
///   Frame  that of the caller.   Units  SI; positions along the ray in m from its origin (the direction has length 1).   Errors  none.
///   Source own derivation: each face keeps an interval of the ray; the solid keeps the intersection of the intervals.
#pragma once

#include <limits>

#include "core/base/geometry.h"

namespace burrhole {

struct Ray {
  Vec3 origin{0.0};               ///< [m]
  Vec3 direction{0.0, 0.0, 1.0};  ///< [-] length 1
};

/// Interval of a ray; empty if out <= in.
struct RaySpan {
  double in = 0.0;                                       ///< [m]
  double out = std::numeric_limits<double>::infinity();  ///< [m]

  [[nodiscard]] bool empty() const noexcept { return !(out > in); }
};

/// Keeps the part where dot(normal, p) <= offset.
[[nodiscard]] RaySpan clip_half_space(RaySpan span, const Ray& ray, const Vec3& normal, double offset) noexcept;
/// Keeps the part inside the box lo..hi.
[[nodiscard]] RaySpan clip_box(RaySpan span, const Ray& ray, const Vec3& lo, const Vec3& hi) noexcept;
/// Keeps the part inside the ball.
[[nodiscard]] RaySpan clip_ball(RaySpan span, const Ray& ray, const Vec3& centre, double radius) noexcept;
/// Keeps the part inside the infinite cylinder around the z axis.
[[nodiscard]] RaySpan clip_cylinder(RaySpan span, const Ray& ray, double radius) noexcept;

/// @returns the difference of two intervals: at most two parts, in order along the ray, empty ones last.
struct RaySpans {
  RaySpan first{0.0, 0.0};
  RaySpan second{0.0, 0.0};
};
[[nodiscard]] RaySpans subtract(const RaySpan& from, const RaySpan& hole) noexcept;

}  // namespace burrhole
