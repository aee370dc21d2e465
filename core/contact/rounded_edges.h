/// core/contact/rounded_edges.h: how far the points of a shell move where the edges of the tool are rounded.
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any; allocates.
///   Source own derivation. The distance to bone, interpolated between voxels, rounds the corner between floor and wall of a hole: up to
///   0.18 voxel inside bone at the corner itself (a wall and a floor half-way between nodes). A sharp rim would rest on it. The solid
///   eroded by a radius and dilated by it again (an opening) has the same faces and edges of that radius. The centre y of a ball of radius
///   r that touches the surface at p is p + r n; if it is nearer than r to another face, it is moved away from that face, and the point
///   moves to the ball's surface, y + r (p - y) / |p - y|.
#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/tool/tool.h"

namespace burrhole {

/// @returns for each point its displacement [m]; zero on smooth faces, and for points that do not cut. Faces are the tangent planes of
/// cutting points nearby. Where the tool is thinner than twice the radius, a smaller radius is used. @param radius [m] > 0.
[[nodiscard]] std::vector<Vec3> rounded_edges(const PointShell& shell, double radius);

}  // namespace burrhole
