/// core/tool/outline.h: the surface of a union of solids. What revolves is a line in the meridian half-plane (r, z), solved exactly; boxes
///   keep their flat faces. A piece of surface that another solid covers is no surface. Shell, mesh and depth all read this.
///   Frame  tool frame, (r, z).   Units  SI.   Source  own derivation, shown in outline_union.cpp.
#pragma once

#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/tool/shape.h"

namespace burrhole {

/// Heights nearer than this are one height [m]: far below any voxel, far above rounding.
inline constexpr double kOutlineTolerance = 1e-9;

/// One smooth stretch of the outline: a straight line, or an arc of an ellipse about a centre on the axis.
struct OutlinePiece {
  std::size_t solid = 0;  ///< index of the owner
  Face face = Face::side;
  Meridian start{0.0};  ///< [m] the material lies to the left of the way from start to end
  Meridian end{0.0};
  bool curved = false;
  double radius = 0.0;       ///< [m] curved: semi-axis across
  double half_height = 0.0;  ///< [m] curved: semi-axis along
  double centre = 0.0;       ///< [m] curved: height of the centre
  double start_angle = 0.0;  ///< [rad] curved: r = radius sin(angle), z = centre - half_height cos(angle)
  double end_angle = 0.0;
  std::vector<double> arc_length;  ///< [m] curved: from the start to equal steps of angle; empty on a line

  [[nodiscard]] double length() const noexcept;
  /// Point at `fraction` of the length, 0 at start, 1 at end; the ends are exact.
  [[nodiscard]] Meridian point(double fraction) const noexcept;
  /// Outward unit normal there.
  [[nodiscard]] Meridian outward(double fraction) const noexcept;
};

/// The pieces of all solids of revolution, chain after chain; within a chain each piece starts where the one before it ends. A chain runs
/// from the axis to the axis, the one nearest to the tip first, or it is a ring that closes on itself (a tube without a bottom).
/// Where surfaces coincide, the solid listed first owns them.
/// @returns ErrorCode::bad_input when the solids, boxes included, are not one body, or meet in a point only.
[[nodiscard]] Result<std::vector<OutlinePiece>> make_outline(std::span<const Solid> solids);

using OutlineChain = std::span<const OutlinePiece>;
[[nodiscard]] std::vector<OutlineChain> chains_of(std::span<const OutlinePiece> outline);

struct NearestFace {
  double distance = 0.0;  ///< [m] >= 0; on arcs within 1e-4 of their radius (chords of 128 steps)
  std::size_t solid = 0;
  Face face = Face::side;
};

/// Nearest face of the union to a point, inside or outside. Linear in the number of pieces. Where boxes and solids of revolution meet, a
/// face counts only if its nearest point is not covered: exact unless a covered patch lies just there.
[[nodiscard]] NearestFace find_nearest_face(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept;

/// Distance to the surface of the union [m], negative inside.
[[nodiscard]] double signed_distance(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept;

/// Whether a point just outside solid `owner`, `p` moved by the tolerance along `outward`, lies in another solid.
[[nodiscard]] bool is_covered(std::span<const Solid> solids, std::size_t owner, const Vec3& p, const Vec3& outward) noexcept;

/// Builds a straight piece, and the arc of an ellipsoid between two heights from below to above.
[[nodiscard]] OutlinePiece make_line_piece(std::size_t solid, Face face, const Meridian& start, const Meridian& end);
[[nodiscard]] OutlinePiece make_arc_piece(std::size_t solid, const Solid& ellipsoid, const Meridian& start, const Meridian& end);

}  // namespace burrhole
