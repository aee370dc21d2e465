/// app/view/cut_mesh.h: a mesh cut open by a plane, with its section closed, for pictures of a bit in section.
///   Frame  that of the mesh.   Units  SI.   Errors  none.   Thread  any.   Source  own derivation, shown in cut_mesh.cpp.
#pragma once

#include "core/tool/tool.h"

namespace burrhole {

/// Removes the side dot(normal, p) > offset of closed surfaces, counter-clockwise seen from outside, which may overlap. The section is filled
/// where any of them has material. @param normal of length 1. @returns a mesh without triangles if nothing is left.
[[nodiscard]] TriangleMesh cut_mesh(const TriangleMesh& mesh, const Vec3& normal, double offset);

}  // namespace burrhole
