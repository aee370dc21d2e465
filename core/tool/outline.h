/// core/tool/outline.h: the outer line of a union of solids in the meridian half-plane (r, z), from the tip's pole to the shaft's end.
///   Where solids overlap, the widest one owns the surface (the first listed when equal). Shell, mesh and depth all read this one line.
///   Frame  tool frame, (r, z).   Units  SI.   Source  own derivation, shown in outline.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/tool/shape.h"

namespace burrhole {

/// Which side of its solid a piece of surface is; the flank of a cone and the whole of an ellipsoid are `side`.
enum class Face : std::uint8_t { bottom, side, top };

/// Heights nearer than this are one height [m]: far below any voxel, far above rounding.
inline constexpr double kOutlineTolerance = 1e-9;

/// One smooth stretch of the outline: a straight line, or an arc of an ellipse about a centre on the axis.
struct OutlinePiece {
  std::size_t solid = 0;  ///< index of the owner
  Face face = Face::side;
  Meridian start{0.0};  ///< [m] nearer to the tip along the outline
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

/// @returns the pieces in order; ErrorCode::bad_input when the solids fall apart or meet only in a point on the axis.
[[nodiscard]] Result<std::vector<OutlinePiece>> make_outline(std::span<const Solid> solids);

struct NearestPiece {
  double distance = 0.0;  ///< [m] >= 0; on arcs within 1e-4 of their radius (chords of 128 steps)
  std::size_t piece = 0;
};

/// Nearest point of the outline to a meridian point, inside or outside. Linear in the number of pieces.
[[nodiscard]] NearestPiece find_nearest(std::span<const OutlinePiece> outline, const Meridian& p) noexcept;

/// Distance to the surface of the union [m], negative inside.
[[nodiscard]] double signed_distance(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept;

}  // namespace burrhole
