/// core/tool/tool_mesh.h: the tool's outline, turned, and its boxes as closed triangle meshes for drawing. A box and what it runs into are
///   drawn through each other: the parts inside are not seen.
///   Frame   tool frame.   Units  SI.   Shape  hard edges: each piece of the outline has vertices of its own, at equal positions.
///   Source  surface of revolution; own derivation.
#pragma once

#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// @param slices flats round the axis, >= 3. @param arc_steps straight steps on each curved piece, >= 1.
[[nodiscard]] TriangleMesh make_tool_mesh(const ToolSpec& spec, int slices = 64, int arc_steps = 32);

}  // namespace burrhole
