/// volumes/phantom/shapes.h: the solids that phantoms are made of: exact distance, outward normal and the stretch of a ray inside.
///   Frame   bone frame.   Units  SI; distances in m, negative inside, Euclidean everywhere.
///   Normals length 1, the gradient of the distance: that of the nearest face, or away from the nearest edge. Where two faces are equally
///           near (there is no gradient) one of them is taken; at a distance of 0 from an edge, one of its faces'.
///   Source  own derivations, each at its shape in shapes.cpp.
#pragma once

#include "core/base/geometry.h"
#include "volumes/phantom/ray_span.h"

namespace burrhole {

/// Distance and direction of the surface as seen from a point.
struct SurfaceDistance {
  double signed_distance = 0.0;  ///< [m] negative inside
  Vec3 normal{0.0, 0.0, 1.0};    ///< outward
};

/// Every shape offers `nearest(p)` and `along(ray, span)`: the parts of the span inside the solid.
struct BoxShape {
  Vec3 centre;
  Vec3 half;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// -thickness <= dot(normal, p) <= 0.
struct SlabShape {
  Vec3 normal;
  double thickness;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

struct BallShape {
  Vec3 centre;
  double radius;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// Below both faces: dot((+-cosine, 0, sine), p) <= 0, sine and cosine of half the angle inside the bone.
struct WedgeShape {
  double sine;
  double cosine;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// -thickness <= z <= 0 less the cylinder of hole_radius round the z axis down to -hole_depth.
struct PitShape {
  double thickness;
  double hole_radius;
  double hole_depth;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// inner_radius <= |p - (0, 0, -outer_radius)| <= outer_radius; with a rim (> 0) only what lies above the centre within it of the z axis.
struct ShellShape {
  double outer_radius;
  double inner_radius;
  double rim_radius;
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;

 private:
  [[nodiscard]] SurfaceDistance nearest_with_rim(const Vec3& q) const noexcept;
};

}  // namespace burrhole
