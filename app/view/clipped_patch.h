/// app/view/clipped_patch.h: the part of a surface where a value at its vertices is at least 0, as coloured triangles.
///   Frame  that of the mesh.   Units  m.   Errors  none.   Thread  any.   Source  own derivation: edges are cut where the value, linear on them, is 0.
#pragma once

#include <functional>
#include <span>

#include "app/view/added_mesh.h"
#include "core/tool/tool.h"

namespace burrhole {

/// @returns the colour of a vertex. @param value at it, 0 where an edge was cut.
using PatchColor = std::function<Rgba8(const Vec3f& p, double value)>;

/// Appends the triangles. @param values of each vertex, finite. @pre values.size() == mesh.positions.size().
void append_clipped(const TriangleMesh& mesh, std::span<const double> values, const PatchColor& color, AddedMesh& out);

}  // namespace burrhole
