/// core/tool/erosion_points.h: the cutting part of a bit as a lattice of points, each with its erosion factor.
///   Frame   tool frame; cell centres at ((i + 1/2), (j + 1/2), (k + 1/2)) * pitch: mirror symmetric in x and y, first layer half a pitch
///           above the tip.   Units  SI.   Errors  out_of_range for the pitch or the number of points.
///   Source  [AcostaLiu07] sec. 3: points at the centres of the voxels of the voxelised primitive, surface and interior; the factor depends
///           on radius, depth and region.
#pragma once

#include "core/base/result.h"
#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// A cell belongs to the bit if its centre is inside the solid, so count * pitch^3 converges to the volume without bias (error of order
/// area * pitch, mostly cancelling). Cells with factor 0 (passive regions, faces with factor 0) have no point.
/// @param pitch [m] > 0.
/// @returns ErrorCode::out_of_range if the pitch is not a positive number or there would be more than kMaxErosionPoints points.
[[nodiscard]] Result<ErosionPoints> make_erosion_points(const ToolSpec& spec, double pitch);

/// @returns the erosion factor [1/rev] at point p of the tool frame; 0 outside the tool.
[[nodiscard]] double erosion_factor_at(const ToolSpec& spec, const Vec3& p) noexcept;

}  // namespace burrhole
