/// core/contact/hollow_direction.h: which way a hollow or flat of bone pushes a tool that nearly fits it.
///   Frame  as named.   Thread  contact; never allocates.
///   Source own derivation. Two surfaces that conform touch along a line, and a twentieth of a voxel of the wall moves the point of touch
///   by a dozen degrees: its own normal says where that point is, not which way the hollow faces. On a drilled floor that leans to the grid
///   a single place is off by two degrees. So all points that nearly touch are asked, each by how near it is to touching. Where bone
///   bulges, on a ball or towards an edge, normals lean apart, the touch is at one place, and nothing is asked.
#pragma once

#include "core/base/geometry.h"
#include "core/contact/surface_probe.h"

namespace burrhole {

/// A shell point that touches.
struct TouchPoint {
  Vec3 place{0.0};               ///< [m] tool frame, as hits have theirs
  double gap = 0.0;              ///< [voxel edges]
  Vec3 normal{0.0, 0.0, 1.0};    ///< of the record there, bone frame
  Vec3 steadied{0.0, 0.0, 1.0};  ///< what is answered where bone bulges; bone frame
};

/// @param near hits of the same look that touch as the point does. @param bone_from_tool axes. @param edge [m] of a voxel, > 0.
/// @returns the outward unit normal to be held by; continuous but for the choice of points: of over 4000 every so many is asked.
[[nodiscard]] Vec3 hollow_direction(const ProbeHits& hits, const HitRange& near, const TouchPoint& touch, const Mat3& bone_from_tool,
                                    double edge) noexcept;

}  // namespace burrhole
