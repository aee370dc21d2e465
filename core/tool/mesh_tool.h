/// core/tool/mesh_tool.h: shell, erosion points and picture of a bit given by a closed surface in the tool frame.
///   Frame   tool frame.   Units  SI.   Source  own derivations, shown in mesh_shell.cpp and core/tool/mesh_slices.cpp.
#pragma once

#include "core/base/result.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Even samples with their triangles' inward normals. No point of the surface is farther than pitch / sqrt(2) from a sample that looks the
/// same way (normals at most 84 degrees apart), as for regions; the two sides of a thin wall have samples of their own. The lowest vertex
/// is one. `cutting` is 1 where spec.cuts_at(z).
/// @returns ErrorCode::out_of_range when there would be more than kMaxShellPoints.
[[nodiscard]] Result<PointShell> make_mesh_shell(const MeshToolSpec& spec, const SurfaceMesh& mesh);

/// Cells of the lattice of core/tool/erosion_points.h whose centres lie inside the surface and at heights that cut.
/// @param pitch [m] > 0. @returns ErrorCode::out_of_range as make_erosion_points does.
[[nodiscard]] Result<ErosionPoints> make_mesh_erosion_points(const MeshToolSpec& spec, const SurfaceMesh& mesh, double pitch);

/// Flat triangles.
[[nodiscard]] TriangleMesh make_mesh_picture(const SurfaceMesh& mesh);

}  // namespace burrhole
