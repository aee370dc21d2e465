/// core/contact/nearest_triangle.h: the triangle of a patch that is nearest to a point, and the side of the surface on which the point lies.
///   Frame  of the patch: bone axes, relative to TrianglePatch::origin.   Units  SI.   Errors  none.   Thread  any; no state.
///   Ties   A point may be nearest to an edge or a vertex, hence to several triangles. The one whose plane the point is deepest below is
///          taken. The side follows from the sum of their normals, each weighted by its angle there [Baerentzen05].
///   Source [TellesONeill10] section 4.3.2: the plane of the nearest triangle; Baerentzen and Aanaes 2005 for the sum of normals.
#pragma once

#include "core/base/assert.h"
#include "core/voxel/triangle_patch.h"

namespace burrhole {

struct NearestTriangle {
  const PatchTriangle* triangle = nullptr;  ///< null: none within the bound
  double distance2 = 0.0;                   ///< [m^2] from the point to the triangle
  double depth = 0.0;                       ///< [m] below its plane; < 0: above
  bool inside = false;                      ///< the point is on the inner side of the surface at its nearest place
  Vec3 from_place{0.0};                     ///< [m] from the nearest place of the surface to the point
  Vec3 normals{0.0};                        ///< [rad] sum of the normals there, each times its angle
};

/// @returns the squared distance [m^2] from a point to a triangle.
[[nodiscard]] double distance2_to(const PatchTriangle& triangle, const Vec3& point) noexcept BH_REALTIME;

/// Searches blocks round the point, then all blocks within the distance found. Each triangle of the patch is compared once at most.
/// @param bound2 [m^2] square of a distance within which a triangle is known to be; infinity: none is known.
[[nodiscard]] NearestTriangle find_nearest(const TrianglePatch& patch, const Vec3& point, double bound2) noexcept BH_REALTIME;

}  // namespace burrhole
