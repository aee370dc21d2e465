/// core/tool/shape.h: the primitives of a bit: solids of revolution about the shaft, with or without a bore, and boxes.
///   Frame  tool frame, axis = z axis; "meridian" coordinates are (r, z), r the distance from the axis.   Units  SI.   Errors  none.
///   Source closed forms of elementary geometry; own choice of primitives ([AcostaLiu07] sec. 2 has sphere and cylinder).
#pragma once

#include <cstdint>
#include <span>

#include "core/base/bounds.h"
#include "core/base/geometry.h"

namespace burrhole {

/// (r, z) [m]: x is the distance from the axis, y the height along it.
using Meridian = glm::dvec2;

enum class SolidKind : std::uint8_t { frustum, ellipsoid, box };

/// Faces of a solid. The flank of a cone and the whole surface of an ellipsoid are `side`; the wall of a bore is `inner`; a box has four
/// flanks instead of a side.
enum class Face : std::uint8_t { bottom, side, top, inner, minus_x, plus_x, minus_y, plus_y };

/// A face of a box and its outward normal.
struct BoxFace {
  Face face;
  std::size_t axis;  ///< 0 x, 1 y, 2 z
  double sign;       ///< [-] of the normal along the axis, -1 or 1
};
[[nodiscard]] std::span<const BoxFace> box_faces() noexcept;

/// Solid of revolution between two heights, or a box along the axes of the tool frame. Cylinders, cones and tubes are frusta, spheres are
/// ellipsoids; make one by a named function below.
struct Solid {
  SolidKind kind = SolidKind::frustum;
  double z_low = 0.0;         ///< [m]
  double z_high = 0.0;        ///< [m] > z_low
  double low_radius = 0.0;    ///< [m] frustum: at z_low; ellipsoid: largest radius
  double high_radius = 0.0;   ///< [m] frustum: at z_high; ellipsoid: largest radius
  double low_bore = 0.0;      ///< [m] frustum: radius of a concentric hole at z_low, <= low_radius; 0: none
  double high_bore = 0.0;     ///< [m] frustum: the same at z_high
  glm::dvec2 middle{0.0};     ///< [m] box: x and y of its centre
  glm::dvec2 half_size{0.0};  ///< [m] box: half its width (x) and depth (y)

  [[nodiscard]] bool revolves() const noexcept { return kind != SolidKind::box; }
  [[nodiscard]] bool bored() const noexcept { return low_bore > 0.0 || high_bore > 0.0; }
  [[nodiscard]] double height() const noexcept { return z_high - z_low; }
  /// Greatest distance from the axis [m].
  [[nodiscard]] double largest_radius() const noexcept;
  [[nodiscard]] Bounds bounds() const noexcept;
  /// Coefficients of r^2(z) = a z^2 + b z + c on [z_low, z_high]: every solid of revolution here is a quadric.
  struct Quadratic {
    double a, b, c;  ///< [-], [m], [m^2]
  };
  [[nodiscard]] Quadratic squared_radius_form() const noexcept;
  /// @returns r^2 [m^2] of the outer surface at height z, never negative; 0 outside [z_low, z_high]. Solids of revolution only.
  [[nodiscard]] double squared_radius(double z) const noexcept;
  [[nodiscard]] double radius(double z) const noexcept;
  [[nodiscard]] double bore(double z) const noexcept;  ///< [m] of the hole at height z
  /// @returns whether p is inside; exact, the surface and the wall of a bore are included.
  [[nodiscard]] bool contains(const Vec3& p) const noexcept;
  [[nodiscard]] double volume() const noexcept;  ///< [m^3] closed form
  [[nodiscard]] double area() const noexcept;    ///< [m^2] closed form, end faces and bore included
};

/// Size of a frustum.
struct FrustumSize {
  double z_low = 0.0;        ///< [m]
  double height = 0.0;       ///< [m] > 0
  double low_radius = 0.0;   ///< [m] >= 0
  double high_radius = 0.0;  ///< [m] >= 0, not both 0
};

[[nodiscard]] Solid make_frustum(const FrustumSize& size) noexcept;
[[nodiscard]] Solid make_cylinder(double z_low, double height, double radius) noexcept;
/// Hollow frustum: the outer wall and a bore. @pre the bore is nowhere wider than the wall, and narrower at one end at least.
struct BoreSize {
  double low_radius = 0.0;   ///< [m] >= 0
  double high_radius = 0.0;  ///< [m] >= 0
};
[[nodiscard]] Solid make_tube(const FrustumSize& outer, const BoreSize& bore) noexcept;
/// Tip at z_low, base of `radius` at the top.
[[nodiscard]] Solid make_cone(double z_low, double height, double radius) noexcept;
[[nodiscard]] Solid make_sphere(double z_low, double radius) noexcept;
/// Spheroid about the axis, `height` from pole to pole.
[[nodiscard]] Solid make_ellipsoid(double z_low, double height, double radius) noexcept;

/// Size of a box.
struct BoxSize {
  double z_low = 0.0;      ///< [m]
  double height = 0.0;     ///< [m] > 0
  glm::dvec2 size{0.0};    ///< [m] > 0, along x and y
  glm::dvec2 centre{0.0};  ///< [m] x and y of its centre
};
[[nodiscard]] Solid make_box(const BoxSize& size) noexcept;

}  // namespace burrhole
