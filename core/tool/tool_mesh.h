/// core/tool/tool_mesh.h: closed triangle meshes for drawing, from the outline of a tool and its boxes. Boxes and what they intersect are
///   drawn overlapping: the hidden parts are not visible.
///   Frame   tool frame.   Units  SI.   Errors  none.   Shape  hard edges: each piece of the outline has its own vertices.
///   Source  surface of revolution; own derivation.
#pragma once

#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// @param slices facets around the axis, >= 3. @param arc_steps straight segments on each curved piece, >= 1.
[[nodiscard]] TriangleMesh make_tool_mesh(const ToolSpec& spec, int slices = 64, int arc_steps = 32);

}  // namespace burrhole
