/// volumes/write/ball_surface.h: the 0.5 surface of a bone as a closed triangle mesh, by ball pivoting (core/mesh).
///   Frame  bone frame (LPS).   Units  m.   Errors  bad_input: no surface, a bone that is too long.   Thread  one.
#pragma once

#include "volumes/write/bone_surface.h"

namespace burrhole {

/// @returns the surface, counter-clockwise seen from outside, with its vertices moved to the 0.5 level. Each edge belongs to two triangles, or
/// to four where parts touch. Takes 4 bytes per voxel of the box round all regions, and the mesh.
[[nodiscard]] Result<SurfaceMesh> make_ball_surface(const DensitySource& density);

}  // namespace burrhole
