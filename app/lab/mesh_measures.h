/// app/lab/mesh_measures.h: how good a mesh of bone is: shape of its triangles, holes, volume, and distance to the true surface.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any.
///   Distance   In both directions: from the mesh to the surface, at four equal parts of each triangle by their area, and at its corners for
///     the largest; from the surface to the mesh, at the points where lines along the three axes, kLinePitch apart, cross the surface. A
///     line along an axis meets area in proportion to the component of the normal, so a point counts 1 / (|nx| + |ny| + |nz|).
#pragma once

#include <functional>
#include <vector>

#include "core/base/bounds.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

inline constexpr double kLinePitch = 0.5;  ///< [voxel] between the lines that sample a true surface

/// A body whose surface is known.
struct KnownSurface {
  std::function<double(const Vec3&)> value;  ///< [-] negative in bone, zero at the surface, continuous
  bool is_distance = false;                  ///< |value| is the distance [voxel] to the surface, everywhere
  Bounds bounds;                             ///< [voxels] around the surface
};

/// A point of the true surface.
struct KnownPoint {
  Vec3 at;              ///< [voxels]
  Vec3 normal;          ///< [-] outward
  double weight = 0.0;  ///< [-] in proportion to the area that it stands for
};

struct MeshShape {
  std::size_t triangles = 0;
  std::size_t border_edges = 0;        ///< of one triangle
  std::size_t non_manifold_edges = 0;  ///< of more than two triangles
  double volume = 0.0;                 ///< [voxel^3] signed
  double least_angle_deg = 0.0;
  double below_20_percent = 0.0;  ///< share of triangles whose smallest angle is below 20 degrees [%]
};

struct MeshDistance {
  double mean = 0.0, p99 = 0.0, most = 0.0;  ///< [voxel] 99th percentile by area
};

/// @pre the mesh has a triangle.
[[nodiscard]] MeshShape measure_mesh_shape(const SurfaceMesh& mesh);
/// @returns the points where the lines cross the surface: a sign change between two places half a line pitch apart, refined to 1e-9 voxel.
[[nodiscard]] std::vector<KnownPoint> sample_surface(const KnownSurface& surface);
/// @returns the volume [voxel^3] of bone: along lines in x, a fifth of a voxel apart. Its error is that of the midpoint rule.
[[nodiscard]] double volume_of(const KnownSurface& surface);
/// @param points of sample_surface(). @pre the mesh has a triangle, and there is a point.
[[nodiscard]] MeshDistance distance_to_surface(const SurfaceMesh& mesh, const KnownSurface& surface, const std::vector<KnownPoint>& points);
[[nodiscard]] MeshDistance distance_to_mesh(const std::vector<KnownPoint>& points, const SurfaceMesh& mesh);
/// @returns the distance [voxel] of a point to a triangle.
[[nodiscard]] double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& corners);

}  // namespace burrhole
