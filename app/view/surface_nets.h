/// app/view/surface_nets.h: the zero surface of a field as triangles.
///   Frame   that of the field.   Units  m.   Errors  none.   Thread  uses all cores.
///   Source  surface nets (Gibson, MICCAI 1998): a vertex in each cell of a lattice that the surface crosses, at the mean of the crossings of its edges, and
///           a quadrangle for each edge of the lattice with a crossing. Own addition: Newton's steps move the vertices onto the surface.
#pragma once

#include <functional>

#include "core/base/bounds.h"
#include "core/tool/tool.h"

namespace burrhole {

/// A field in space: positive outside, negative inside, NaN where it is not known. It is called from several threads.
using FieldAt = std::function<double(const Vec3&)>;

/// @param box [m] that contains the surface. @param pitch [m] > 0 of the lattice. @returns the surface, with vertices on the trilinear
/// interpolation of the field on the lattice, normals towards the outside, and triangles counter-clockwise from there. It is open where the box
/// or the known field ends.
[[nodiscard]] TriangleMesh make_surface_mesh(const FieldAt& field, const Bounds& box, double pitch);

}  // namespace burrhole
