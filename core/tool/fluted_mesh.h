/// core/tool/fluted_mesh.h: a bit as it looks: flutes and cutting edges on what cuts, made from the tool file's own dimensions. For pictures
///   alone: what is felt and what erodes is the solid that the turning bit sweeps, and this mesh sweeps the same.
///   Frame   tool frame.   Units  SI.   Source  own derivation. Numbers of edges, rake and relief are drawn from pictures of bits, not measured.
#pragma once

#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// How the edges of a bit are set.
struct CuttingEdges {
  int count = 0;        ///< 0: none, nothing that revolves cuts
  double twist = 0.0;   ///< [rad/m] right-handed
  double depth = 0.0;   ///< [-] of the flutes, as a share of the distance from the axis
  double relief = 0.0;  ///< [m] by which flat ends fall back behind their edges
};

/// By the lowest region that cuts: a cone has two lips, a tube teeth, a flat bit of 8 mm and more four edges, a burr an edge about every
/// 1.6 mm of its girth, 6 to 12, on a helix.
[[nodiscard]] CuttingEdges find_cutting_edges(const ToolSpec& spec);

/// Closed, turned counter-clockwise seen from outside, with hard edges. No vertex lies outside the bit's solids; each point of their
/// surface is swept within 0.1 mm by a turn of the mesh (a test says so of every shipped tool). The bit cuts turning clockwise seen from
/// above, from +z.
[[nodiscard]] TriangleMesh make_fluted_mesh(const ToolSpec& spec);

}  // namespace burrhole
