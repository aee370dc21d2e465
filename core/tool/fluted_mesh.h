/// core/tool/fluted_mesh.h: mesh of a bit with flutes and cutting edges, for pictures only. Contact and erosion use the solid of revolution
///   that the spinning bit sweeps; the fluted mesh sweeps the same solid,
///   except for the body of a twist drill (as_drawn()).
///   Frame   tool frame.   Units  SI.   Errors  none.
///   Source  own derivation. Numbers of edges, rake and relief are estimates from pictures of bits, not measurements.
#pragma once

#include "core/tool/tool.h"
#include "core/tool/tool_spec.h"

namespace burrhole {

/// Number and shape of the cutting edges of a bit.
struct CuttingEdges {
  int count = 0;        ///< 0: no cutting edges, no solid of revolution cuts
  double twist = 0.0;   ///< [rad/m] of the helix, right-handed
  double depth = 0.0;   ///< [-] of the flutes, as a share of the distance from the axis
  double relief = 0.0;  ///< [m] axial relief of flat ends behind their edges
};

/// Chooses the edges by the lowest cutting region, and their number by the key `teeth` where the tool file has it: two lips on a cone, whose
/// flutes continue on the passive cylinder above, teeth on a tube, four edges on a flat bit of at least 8 mm, and on a burr one edge per 1.6 mm
/// of circumference (6 to 12) on a helix. Boxes that cut have the teeth of a saw.
[[nodiscard]] CuttingEdges find_cutting_edges(const ToolSpec& spec);
/// @returns Tool::teeth: the key `teeth`, or the number of edges by the shape, or 2 for a tool that is no solid of revolution.
[[nodiscard]] int teeth_of(const ToolSpec& spec);

/// The tool as pictures show it. The body of a twist drill has margins of nearly the diameter of its point along its whole length, and flutes
/// between; for contact it is a thinner cylinder, since flutes and clearance carry no load. In pictures it is as wide as its margins are.
/// @returns the same tool if it is no twist drill, or its body is as wide already.
[[nodiscard]] ToolSpec as_drawn(const ToolSpec& spec);

/// @returns a closed mesh of as_drawn(), counter-clockwise seen from outside, with hard edges. No vertex lies outside its solids. One revolution of
/// the mesh sweeps every point of their surface to within 0.1 mm (tested for every shipped tool). The bit cuts when it turns clockwise seen
/// from above (+z).
[[nodiscard]] TriangleMesh make_fluted_mesh(const ToolSpec& as_filed);

}  // namespace burrhole
