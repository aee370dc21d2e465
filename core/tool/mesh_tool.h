/// core/tool/mesh_tool.h: point shell, erosion points and drawn mesh of a bit given by a closed surface in the tool frame.
///   Frame   tool frame.   Units  SI.   Errors  out_of_range.   Source  own derivations, shown in mesh_shell.cpp and mesh_slices.cpp.
#pragma once

#include "core/base/result.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Samples the surface evenly, with the inward normals of the triangles. Every point of the surface lies within pitch / sqrt(2) of a sample
/// whose normal differs by at most 84 degrees, as for regions; the two sides of a thin wall have separate samples. The lowest vertex is a
/// sample. `cutting` is 1 where spec.cuts_at(z).
/// @returns ErrorCode::out_of_range if there would be more than kMaxShellPoints points.
[[nodiscard]] Result<PointShell> make_mesh_shell(const MeshToolSpec& spec, const SurfaceMesh& mesh);

/// Cells of the lattice of core/tool/erosion_points.h whose centres lie inside the surface at cutting heights.
/// @param pitch [m] > 0. @returns ErrorCode::out_of_range as make_erosion_points().
[[nodiscard]] Result<ErosionPoints> make_mesh_erosion_points(const MeshToolSpec& spec, const SurfaceMesh& mesh, double pitch);

/// Flat-shaded triangles.
[[nodiscard]] TriangleMesh make_mesh_picture(const SurfaceMesh& mesh);

}  // namespace burrhole
