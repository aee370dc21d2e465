/// core/tool/point_shell.h: evenly spaced sample points on the surface of a tool, with inward normals.
///   Frame   tool frame.   Units  SI, normals of length 1.   Errors  out_of_range.
///   Source  [AcostaLiu07] sec. 2 names the parameters (radius, height, stacks, slices, voxel size); the even sampling is our own
///           derivation, shown in point_shell.cpp.
#pragma once

#include "core/base/result.h"
#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// Samples the surface of the union of the regions, including the walls of bores. The outline meets the axis in single points; the first is
/// normally the tip. Every ring is mirror symmetric in x and in y. An edge has one ring or row, whose normals bisect those of the adjoining
/// faces. `cutting` is 1 where the factor of the region and of a face touching the point are > 0.
/// @returns ErrorCode::out_of_range if there would be more than kMaxShellPoints points.
[[nodiscard]] Result<PointShell> make_point_shell(const ToolSpec& spec);

}  // namespace burrhole
