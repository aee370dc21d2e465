#include "core/tool/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;

/// Area of a spheroid with semi-axes a, a, c: 2 pi a^2 (1 + (c / (a e)) asin e) prolate, 2 pi a^2 (1 + ((1 - e^2) / e) atanh e) oblate.
double spheroid_area(double a, double c) noexcept {
  const double ratio = std::min(a, c) / std::max(a, c);
  const double e = std::sqrt(std::max(0.0, 1.0 - ratio * ratio));
  if (e < 1e-6) return 4.0 * kPi * a * c;  // both forms lose digits near the sphere; their series differ from this by e^2 only
  if (c > a) return 2.0 * kPi * a * a * (1.0 + c / (a * e) * std::asin(e));
  return 2.0 * kPi * a * a * (1.0 + (1.0 - e * e) / e * std::atanh(e));
}

}  // namespace

Solid::Quadratic Solid::squared_radius_form() const noexcept {
  if (kind == SolidKind::ellipsoid) {
    const double centre = 0.5 * (z_low + z_high);
    const double k = low_radius / (0.5 * height());  // r^2 = R^2 - k^2 (z - centre)^2
    return {-k * k, 2.0 * k * k * centre, low_radius * low_radius - k * k * centre * centre};
  }
  const double slope = (high_radius - low_radius) / height();
  const double at_zero = low_radius - slope * z_low;
  return {slope * slope, 2.0 * slope * at_zero, at_zero * at_zero};
}

double Solid::squared_radius(double z) const noexcept {
  if (z < z_low || z > z_high) return 0.0;
  if (kind == SolidKind::ellipsoid) {
    const double half = 0.5 * height();
    const double u = (z - 0.5 * (z_low + z_high)) / half;
    return std::max(0.0, low_radius * low_radius * (1.0 - u * u));
  }
  const double r = low_radius + (high_radius - low_radius) * ((z - z_low) / height());
  return r * r;
}

double Solid::radius(double z) const noexcept { return std::sqrt(squared_radius(z)); }

bool Solid::contains(const Vec3& p) const noexcept { return p.z >= z_low && p.z <= z_high && p.x * p.x + p.y * p.y <= squared_radius(p.z); }

double Solid::volume() const noexcept {
  if (kind == SolidKind::ellipsoid) return 4.0 / 3.0 * kPi * low_radius * low_radius * (0.5 * height());
  return kPi / 3.0 * height() * (low_radius * low_radius + low_radius * high_radius + high_radius * high_radius);
}

double Solid::area() const noexcept {
  if (kind == SolidKind::ellipsoid) return spheroid_area(low_radius, 0.5 * height());
  const double rise = high_radius - low_radius;
  const double slant = std::sqrt(rise * rise + height() * height());
  return kPi * (low_radius * low_radius + high_radius * high_radius + (low_radius + high_radius) * slant);
}

Solid make_frustum(const FrustumSize& size) noexcept {
  return {SolidKind::frustum, size.z_low, size.z_low + size.height, size.low_radius, size.high_radius};
}

Solid make_cylinder(double z_low, double height, double radius) noexcept {
  return make_frustum({.z_low = z_low, .height = height, .low_radius = radius, .high_radius = radius});
}

Solid make_cone(double z_low, double height, double radius) noexcept {
  return make_frustum({.z_low = z_low, .height = height, .low_radius = 0.0, .high_radius = radius});
}

Solid make_sphere(double z_low, double radius) noexcept { return make_ellipsoid(z_low, 2.0 * radius, radius); }

Solid make_ellipsoid(double z_low, double height, double radius) noexcept {
  return {SolidKind::ellipsoid, z_low, z_low + height, radius, radius};
}

}  // namespace burrhole
