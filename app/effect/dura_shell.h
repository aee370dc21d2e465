/// app/effect/dura_shell.h: the sheet of [dura] as triangles: a smooth shell, round lips where it is torn, and the brain in the rent.
///   Between nodes the shell follows their normals (Phong tessellation). A rent has a smooth edge (dura_rent.h) where both faces meet in a half
///   circle, with shared vertices, so that light runs round it; towards the edge the dura thickens and curls outwards (an assumption). The outer
///   edge, which bone covers, is cut square.
///   Frame  nodes in the sheet frame, triangles in the bone frame.   Units  m.   Errors  none.   Thread  any.
///   Source  own; Phong tessellation: Boubekeur & Alexa 2008.
#pragma once

#include <vector>

#include "app/effect/dura_rent.h"
#include "app/view/added_mesh.h"

namespace burrhole {

/// What a picture shows of a sheet.
struct DuraShell {
  const ElasticSheet* sheet = nullptr;           ///< for lattice and rest
  const std::vector<Vec3>* positions = nullptr;  ///< [m] of nodes
  const std::vector<Vec3>* normals = nullptr;    ///< [-] of nodes, unit
  const DuraRent* rent = nullptr;
  Pose bone_from_sheet{};
  double thickness = 0.0;  ///< [m]
};

inline constexpr double kBrainBelow = 0.1e-3;  ///< [m] of the brain in a rent below the inner face (an assumption)

/// Appends the shell, closed, and where it is torn the surface of the brain.
void append_dura(const DuraShell& shell, AddedMesh& out);

}  // namespace burrhole
