/// volumes/phantom/shapes.h: the solids of phantoms: exact distance, outward normal, and the part of a ray inside.
///   Frame   bone frame.   Units  SI; Euclidean distances in m, negative inside.   Errors  none.   Thread  any.
///   Normals length 1, the gradient of the distance: the normal of the nearest face, or the direction away from the nearest edge. Where two
///           faces are equally near (no gradient) it is the normal of one of them, also at distance 0 from an edge.
///   Source  own derivations, shown at each shape in shapes.cpp.
#pragma once

#include "core/base/geometry.h"
#include "volumes/phantom/ray_span.h"

namespace burrhole {

/// Distance and normal of the surface at a point.
struct SurfaceDistance {
  double signed_distance = 0.0;  ///< [m] negative inside
  Vec3 normal{0.0, 0.0, 1.0};    ///< [-] outward
};

/// Every shape has `nearest(p)` and `along(ray, span)`, which returns the parts of the span inside the solid.
struct BoxShape {
  Vec3 centre;  ///< [m]
  Vec3 half;    ///< [m] half size
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// -thickness <= dot(normal, p) <= 0.
struct SlabShape {
  Vec3 normal;       ///< [-] length 1
  double thickness;  ///< [m]
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

struct BallShape {
  Vec3 centre;    ///< [m]
  double radius;  ///< [m]
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// All points within `radius` of the part -half <= x <= half of the line y = 0, z = -radius.
struct CapsuleShape {
  double half;    ///< [m]
  double radius;  ///< [m]
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// Below both faces: dot((+-cosine, 0, sine), p) <= 0, sine and cosine of half the angle inside the bone.
struct WedgeShape {
  double sine;    ///< [-]
  double cosine;  ///< [-]
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// -thickness <= z <= 0 without the cylinder of hole_radius around the z axis down to -hole_depth.
struct PitShape {
  double thickness;    ///< [m]
  double hole_radius;  ///< [m]
  double hole_depth;   ///< [m]
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;
};

/// inner_radius <= |p - (0, 0, -outer_radius)| <= outer_radius. With a rim (> 0): only the part above the centre within rim_radius of the z
/// axis.
struct ShellShape {
  double outer_radius;  ///< [m]
  double inner_radius;  ///< [m]
  double rim_radius;    ///< [m] 0: no rim
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p) const noexcept;
  [[nodiscard]] RaySpans along(const Ray& ray, const RaySpan& span) const noexcept;

 private:
  [[nodiscard]] SurfaceDistance nearest_with_rim(const Vec3& q) const noexcept;
};

}  // namespace burrhole
