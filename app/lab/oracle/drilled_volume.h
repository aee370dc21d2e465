/// app/lab/oracle/drilled_volume.h: closed forms of the volume that a straight bit removes when its widest cutting part has passed through
///   bone, as an oracle for removed volume and mass. A solid bit leaves a cylinder, a crown leaves a ring round its core.
///   Frame  bit axis = z; the outer face of bone is at z = 0 on the axis.   Units  SI.   Errors  none.   Thread  any.
///   Source own derivation; shares no code with erosion, contact or the phantoms.
#pragma once

namespace burrhole {

/// The cutting part at its widest, seen along the axis.
struct SweptBit {
  double radius = 0.0;  ///< [m] > 0
  double bore = 0.0;    ///< [m] radius of the core that a crown leaves; 0: a solid bit
};

/// @returns [m^3] in a plate between two planes across the axis. @param thickness [m].
[[nodiscard]] double through_plate(const SweptBit& bit, double thickness) noexcept;

/// @returns [m^3] in a block with one straight edge. @param thickness [m]. @param inset [m] of the axis from the edge, into bone if > 0; all
/// other edges are farther than the bit's radius.
[[nodiscard]] double through_edge(const SweptBit& bit, double thickness, double inset) noexcept;

/// @returns [m^3] in a spherical shell drilled along a radius. @param thickness [m]. @param curvature [m] radius of the outer surface,
/// more than thickness plus the bit's radius.
[[nodiscard]] double through_shell(const SweptBit& bit, double thickness, double curvature) noexcept;

}  // namespace burrhole
