/// core/mesh/pivot_rules.h: errors that tests put into ball pivoting. Private to core/mesh and its tests.
///   Frame  index.   Units  voxels.   Errors  those of BallMesh::create().   Thread  as BallMesh.
#pragma once

#include "core/mesh/ball_mesh.h"

namespace burrhole {

/// With other values than these the mesh is wrong.
struct PivotRules {
  TieRule tie = TieRule::lowest_corner;
  std::uint64_t missed_glue = 0;  ///< the edge that would be glued as this one, counted from 1, is left open; 0: none is
};

/// As BallMesh::create(), with these rules.
[[nodiscard]] Result<BallMesh> make_sabotaged_mesh(const VoxelBox& box, const BallMeshConfig& config, const PivotRules& rules);

}  // namespace burrhole
