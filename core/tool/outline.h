/// core/tool/outline.h: the surface of a union of solids. Solids of revolution give curves in the meridian half-plane (r, z), intersected
/// in
///   closed form; boxes keep their flat faces. A piece covered by another solid is not part of the surface. Point shell, mesh and depth
///   are made from this outline.
///   Frame  tool frame, (r, z).   Units  SI.   Errors  bad_input.   Source  own derivation, shown in outline_union.cpp.
#pragma once

#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/tool/shape.h"

namespace burrhole {

/// Heights [m] closer than this are equal: far below a voxel, far above rounding.
inline constexpr double kOutlineTolerance = 1e-9;

/// One smooth piece of the outline: a straight line, or an arc of an ellipse with its centre on the axis.
struct OutlinePiece {
  std::size_t solid = 0;  ///< index of the owning solid
  Face face = Face::side;
  Meridian start{0.0};  ///< [m] the material lies to the left of the direction from start to end
  Meridian end{0.0};    ///< [m]
  bool curved = false;
  double radius = 0.0;             ///< [m] curved: semi-axis across
  double half_height = 0.0;        ///< [m] curved: semi-axis along
  double centre = 0.0;             ///< [m] curved: height of the centre
  double start_angle = 0.0;        ///< [rad] curved: r = radius sin(angle), z = centre - half_height cos(angle)
  double end_angle = 0.0;          ///< [rad] curved: angle at the end
  std::vector<double> arc_length;  ///< [m] curved: length from the start to equal steps of angle; empty for a line

  [[nodiscard]] double length() const noexcept;
  /// @returns the point [m] at `fraction` of the length, 0 at start, 1 at end; the ends are exact.
  [[nodiscard]] Meridian point(double fraction) const noexcept;
  /// @returns the outward unit normal at `fraction`.
  [[nodiscard]] Meridian outward(double fraction) const noexcept;
};

/// @returns the pieces of all solids of revolution, chain after chain; within a chain each piece starts where the previous one ends. A
/// chain runs from the axis to the axis (the one nearest to the tip first) or is a closed ring (a tube without a bottom). Where surfaces
/// coincide, the solid listed first owns them. ErrorCode::bad_input if the solids, boxes included, are not one body, or touch in a point
/// only.
[[nodiscard]] Result<std::vector<OutlinePiece>> make_outline(std::span<const Solid> solids);

using OutlineChain = std::span<const OutlinePiece>;
[[nodiscard]] std::vector<OutlineChain> chains_of(std::span<const OutlinePiece> outline);

struct NearestFace {
  double distance = 0.0;  ///< [m] >= 0; on arcs accurate to 1e-4 of the radius (chords of 128 steps)
  std::size_t solid = 0;
  Face face = Face::side;
};

/// @returns the face of the union nearest to p, inside or outside. Linear in the number of pieces. Where boxes and solids of revolution
/// meet, a face counts only if its nearest point is not covered; the result is exact unless a covered patch contains that point.
[[nodiscard]] NearestFace find_nearest_face(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept;

/// @returns the distance [m] of p to the surface of the union, negative inside.
[[nodiscard]] double signed_distance(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept;

/// @returns whether `p` on solid `owner`, moved by the tolerance along `outward`, lies in another solid.
[[nodiscard]] bool is_covered(std::span<const Solid> solids, std::size_t owner, const Vec3& p, const Vec3& outward) noexcept;

/// Make a straight piece, and the arc of an ellipsoid between two heights from below to above.
[[nodiscard]] OutlinePiece make_line_piece(std::size_t solid, Face face, const Meridian& start, const Meridian& end);
[[nodiscard]] OutlinePiece make_arc_piece(std::size_t solid, const Solid& ellipsoid, const Meridian& start, const Meridian& end);

}  // namespace burrhole
