/// core/tool/point_shell.h: the tool's surface as evenly spread sample points with inward normals.
///   Frame   tool frame.   Units  SI, normals of length 1.
///   Source  [AcostaLiu07] sec. 2 names the parameters (radius, height, stacks, slices, voxel size); the even sampling is our own
///           derivation, shown in point_shell.cpp.
#pragma once

#include "core/base/result.h"
#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// Samples the surface of the union of the regions, walls of bores included. Where the tool's line meets the axis there is one point: as a
/// rule the first is the tip. Every ring is mirror symmetric in x and in y; an edge has one ring or row, whose normals are halfway between
/// the faces that meet there. `cutting` is 1 where the region's factor and that of a face touching the point are above 0.
/// @returns ErrorCode::out_of_range when there would be more than kMaxShellPoints.
[[nodiscard]] Result<PointShell> make_point_shell(const ToolSpec& spec);

}  // namespace burrhole
