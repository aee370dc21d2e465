/// core/contact/conforming_normal.h: conforming contact normal: the contact normal where a tool nearly fits a hollow or flat of bone.
///   Frame  as named.   Units  as named.   Thread  contact; never allocates.
///   Source own derivation. Two conforming surfaces touch along a line. A change of the wall by a twentieth of a voxel moves the contact
///   point by about twelve degrees, so the normal at that point is not the normal of the hollow. On a drilled floor that is oblique to the
///   grid the normal of a single place has an error of two degrees. Therefore the function averages the normals of all nearly touching
///   points, weighted by their proximity to contact. Where bone is convex, as on a ball or towards an edge, the normals diverge and contact
///   is at one place; there the function returns the normal of that place.
#pragma once

#include "core/base/geometry.h"
#include "core/contact/surface_probe.h"

namespace burrhole {

/// A shell point in contact.
struct TouchPoint {
  Vec3 place{0.0};               ///< [m] tool frame, as in the hits
  double gap = 0.0;              ///< [voxels] gap, in voxel edges
  Vec3 normal{0.0, 0.0, 1.0};    ///< [-] normal of the record there, bone frame
  Vec3 steadied{0.0, 0.0, 1.0};  ///< [-] result where bone is convex, bone frame
};

/// @param near hits of the same probe, of the same kind as the point (cutting or passive). @param bone_from_tool rotation. @param edge [m]
/// of a voxel, > 0.
/// @returns the outward unit normal of contact. It is continuous except for the selection of points: from 4000 hits on, an even subset is
/// used.
[[nodiscard]] Vec3 conforming_normal(const ProbeHits& hits, const HitRange& near, const TouchPoint& touch, const Mat3& bone_from_tool,
                                     double edge) noexcept;

}  // namespace burrhole
