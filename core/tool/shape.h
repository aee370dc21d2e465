/// core/tool/shape.h: the primitives bits are stacked from: solids of revolution about the shaft.
///   Frame  tool frame, axis = z axis; "meridian" coordinates are (r, z), r the distance from the axis.   Units  SI.
///   Source closed forms of elementary geometry; own choice of primitives ([AcostaLiu07] sec. 2 has sphere and cylinder).
#pragma once

#include <cstdint>

#include "core/base/geometry.h"

namespace burrhole {

/// (r, z) [m]: x is the distance from the axis, y the height along it.
using Meridian = glm::dvec2;

enum class SolidKind : std::uint8_t { frustum, ellipsoid };

/// Solid of revolution between two heights. Cylinders and cones are frusta, spheres are ellipsoids; make one by a named function below.
struct Solid {
  SolidKind kind = SolidKind::frustum;
  double z_low = 0.0;        ///< [m]
  double z_high = 0.0;       ///< [m] > z_low
  double low_radius = 0.0;   ///< [m] frustum: at z_low; ellipsoid: largest radius
  double high_radius = 0.0;  ///< [m] frustum: at z_high; ellipsoid: largest radius

  [[nodiscard]] double height() const noexcept { return z_high - z_low; }
  [[nodiscard]] double largest_radius() const noexcept { return low_radius > high_radius ? low_radius : high_radius; }
  /// Coefficients of r^2(z) = a z^2 + b z + c on [z_low, z_high]: every solid here is a quadric.
  struct Quadratic {
    double a, b, c;
  };
  [[nodiscard]] Quadratic squared_radius_form() const noexcept;
  /// r^2 [m^2] of the surface at height z, never negative; 0 outside [z_low, z_high].
  [[nodiscard]] double squared_radius(double z) const noexcept;
  [[nodiscard]] double radius(double z) const noexcept;
  /// Exact inside test, surface included.
  [[nodiscard]] bool contains(const Vec3& p) const noexcept;
  [[nodiscard]] double volume() const noexcept;  ///< [m^3] closed form
  [[nodiscard]] double area() const noexcept;    ///< [m^2] closed form, end faces included
};

/// What frusta are described by.
struct FrustumSize {
  double z_low = 0.0;        ///< [m]
  double height = 0.0;       ///< [m] > 0
  double low_radius = 0.0;   ///< [m] >= 0
  double high_radius = 0.0;  ///< [m] >= 0, not both 0
};

[[nodiscard]] Solid make_frustum(const FrustumSize& size) noexcept;
[[nodiscard]] Solid make_cylinder(double z_low, double height, double radius) noexcept;
/// Tip down at z_low, base of `radius` on top.
[[nodiscard]] Solid make_cone(double z_low, double height, double radius) noexcept;
[[nodiscard]] Solid make_sphere(double z_low, double radius) noexcept;
/// Spheroid about the axis, `height` from pole to pole.
[[nodiscard]] Solid make_ellipsoid(double z_low, double height, double radius) noexcept;

}  // namespace burrhole
