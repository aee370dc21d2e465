/// core/tool/cutting_field.h: the cutting part of a bit as a table of signed distances: where between erosion points its surface runs.
///   Frame   tool frame; node (i, j, k) lies at origin + pitch * (i, j, k), i fastest.   Units  SI.
///   Linear interpolation between nodes is off by up to pitch^2 (1/R1 + 1/R2) / 8 on a surface with radii R1 and R2, without bias: nodes
///   are lower by the mean of it. It rounds a sharp edge by a fraction of the pitch.   Source  own derivation.
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
  Vec3 origin{0.0};             ///< [m]
  double pitch = 0.0;           ///< [m]
  double margin = 0.0;          ///< [m] the table reaches at least this far beyond `bounds`
  Vec3i dims{0};                ///< at least 2 an axis, unless nothing cuts: then 0
  Bounds bounds;                ///< [m] of the cutting part
  std::vector<float> distance;  ///< [m] to the surface of the cutting part, negative inside
  std::vector<float> factor;    ///< [1/rev] erosion factor; outside, the mean of the nearest inside
  [[nodiscard]] bool empty() const noexcept { return distance.empty(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return (distance.size() + factor.size()) * sizeof(float); }
};

/// How fine and how wide.
struct CuttingFieldSize {
  double pitch = 0.0;   ///< [m] > 0
  double margin = 0.0;  ///< [m] >= 0
};

inline constexpr std::size_t kMaxCuttingNodes = 64'000'000;

/// Half the voxel edge for wide tools; finer for slim ones, so that interpolation is off by 0.005 voxel at most on a ball; never below an
/// eighth.
/// @param least_radius [m] smallest half-width of the cutting part. The margin is what core/drill/coverage.h asks for.
[[nodiscard]] CuttingFieldSize cutting_field_size(double voxel_edge, double least_radius) noexcept;

/// From any signed distance [m], negative inside, never farther from the truth than the pitch, and a factor [1/rev] inside.
/// @returns ErrorCode::out_of_range when the size is no positive number or there would be more than kMaxCuttingNodes.
[[nodiscard]] Result<CuttingField> make_cutting_field(const Bounds& bounds, const std::function<double(const Vec3&)>& signed_distance,
                                                      const std::function<double(const Vec3&)>& factor, const CuttingFieldSize& size);

/// Of a bit made of regions: exact where one body cuts on all its faces; else what cuts (regions by their order, faces with a factor of 0
/// less their skin) by maxima and minima of distances: the surface is exact, distances far from it are bounds.
[[nodiscard]] Result<CuttingField> make_cutting_field(const ToolSpec& spec, const CuttingFieldSize& size);

/// Of a bit given by a closed surface: exact up to the margin from the surface, between its cutting heights.
[[nodiscard]] Result<CuttingField> make_mesh_cutting_field(const MeshToolSpec& spec, const SurfaceMesh& mesh, const CuttingFieldSize& size);

}  // namespace burrhole
