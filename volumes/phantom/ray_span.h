/// volumes/phantom/ray_span.h: the part of a ray inside a convex solid, clipped by each face in turn.
///   Frame  that of the caller.   Units  SI; positions along the ray in m from its origin (the direction has length 1).   Errors  none.
///   Source own derivation: the part inside the solid is the intersection of the intervals inside each face.
#pragma once

#include <limits>

#include "core/base/geometry.h"

namespace burrhole {

struct Ray {
  Vec3 origin{0.0};               ///< [m]
  Vec3 direction{0.0, 0.0, 1.0};  ///< [-] length 1
};

/// Interval of a ray, by default the whole ray; empty if exit <= enter.
struct RaySpan {
  double enter = 0.0;                                     ///< [m]
  double exit = std::numeric_limits<double>::infinity();  ///< [m]

  [[nodiscard]] bool empty() const noexcept { return !(exit > enter); }
};

/// Keeps the part where dot(normal, p) <= offset. @param normal of any length. @param offset [m] times that length.
[[nodiscard]] RaySpan clip_half_space(RaySpan span, const Ray& ray, const Vec3& normal, double offset) noexcept;
/// Keeps the part inside the box lo..hi.
[[nodiscard]] RaySpan clip_box(RaySpan span, const Ray& ray, const Vec3& lo, const Vec3& hi) noexcept;
/// Keeps the part inside the ball. @param radius [m].
[[nodiscard]] RaySpan clip_ball(RaySpan span, const Ray& ray, const Vec3& centre, double radius) noexcept;
/// Keeps the part inside the infinite cylinder around the z axis. @param radius [m].
[[nodiscard]] RaySpan clip_cylinder(RaySpan span, const Ray& ray, double radius) noexcept;

/// Up to two disjoint intervals.
struct RaySpans {
  RaySpan first{0.0, 0.0};
  RaySpan second{0.0, 0.0};
};
/// @returns `from` without `hole`: at most two parts, in order along the ray, empty ones last.
[[nodiscard]] RaySpans subtract(const RaySpan& from, const RaySpan& hole) noexcept;

}  // namespace burrhole
