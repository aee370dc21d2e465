/// core/tool/cutting_field.h: the cutting part of a bit as a table of signed distances and erosion factors. The table defines the cutting
///   surface between the erosion points.
///   Frame   tool frame; node (i, j, k) lies at origin + pitch * (i, j, k), i fastest. A bit that is a solid of revolution has one plane of
///           nodes: i along the radius, dims.y = 1, origin.x = origin.y = 0.   Units  SI.
///   Errors  out_of_range for a size that is not positive or too many nodes.   Thread  any; immutable once made.
///   Source  own derivation. Linear interpolation between nodes differs by up to pitch^2 (1/R1 + 1/R2) / 8 from a surface with radii R1 and
///           R2. The nodes are lowered by the mean of this difference, so there is no bias. Sharp edges are rounded by a fraction of the
///   pitch.
#pragma once

#include <functional>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/shape.h"
#include "core/tool/surface_mesh.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

struct CuttingField {
  Vec3 origin{0.0};             ///< [m] position of node (0, 0, 0)
  double pitch = 0.0;           ///< [m] spacing of nodes
  double margin = 0.0;          ///< [m] the table extends at least this far beyond `bounds`
  Vec3i dims{0};                ///< [nodes] at least 2 per axis; 0 if nothing cuts
  Bounds bounds;                ///< [m] of the cutting part
  std::vector<float> distance;  ///< [m] to the surface of the cutting part, negative inside
  bool revolved = false;        ///< the table depends on radius and height only, and is one plane
  std::vector<float> factor;    ///< [1/rev] erosion factor; outside, the mean of the nearest nodes inside
  [[nodiscard]] bool empty() const noexcept { return distance.empty(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return (distance.size() + factor.size()) * sizeof(float); }
};

/// Spacing and extent of a cutting field.
struct CuttingFieldSize {
  double pitch = 0.0;   ///< [m] > 0
  double margin = 0.0;  ///< [m] >= 0
};

inline constexpr std::size_t kMaxCuttingNodes = 64'000'000;

/// @returns half the voxel edge for wide tools and less for slim tools, so that the interpolation error on a ball is at most 0.005 voxel;
/// never less than an eighth of the voxel edge. The margin is the one that core/drill/cut_face.h needs.
/// @param voxel_edge [m] > 0. @param least_radius [m] smallest half-width of the cutting part.
[[nodiscard]] CuttingFieldSize cutting_field_size(double voxel_edge, double least_radius) noexcept;

/// Makes a field from a signed distance [m], negative inside, with an error of at most the pitch, and an erosion factor [1/rev] inside.
/// @returns ErrorCode::out_of_range if the size is not a positive number or the field would have more than kMaxCuttingNodes nodes.
[[nodiscard]] Result<CuttingField> make_cutting_field(const Bounds& bounds, const std::function<double(const Vec3&)>& signed_distance,
                                                      const std::function<double(const Vec3&)>& factor, const CuttingFieldSize& size);

/// Makes the field of a bit made of regions. It is exact if one body cuts on all its faces. Otherwise it combines distances by maxima and
/// minima (regions in their order; faces with factor 0 without their skin): the surface is exact, distances far from it are bounds.
[[nodiscard]] Result<CuttingField> make_cutting_field(const ToolSpec& spec, const CuttingFieldSize& size);

/// Makes the field of a bit given by a closed surface, between its cutting heights. It is exact up to `margin` from the surface.
[[nodiscard]] Result<CuttingField> make_mesh_cutting_field(const MeshToolSpec& spec, const SurfaceMesh& mesh, const CuttingFieldSize& size);

}  // namespace burrhole
