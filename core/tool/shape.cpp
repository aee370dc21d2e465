#include "core/tool/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;

/// Area of a spheroid with semi-axes a, a, c: 2 pi a^2 (1 + (c / (a e)) asin e) prolate, 2 pi a^2 (1 + ((1 - e^2) / e) atanh e) oblate.
double spheroid_area(double a, double c) noexcept {
  const double ratio = std::min(a, c) / std::max(a, c);
  const double e = std::sqrt(std::max(0.0, 1.0 - ratio * ratio));
  if (e < 1e-6) return 4.0 * kPi * a * c;  // both forms lose digits near the sphere; the series differ from this by e^2 only
  if (c > a) return 2.0 * kPi * a * a * (1.0 + c / (a * e) * std::asin(e));
  return 2.0 * kPi * a * a * (1.0 + (1.0 - e * e) / e * std::atanh(e));
}

double frustum_volume(double height, double low, double high) noexcept {
  return kPi / 3.0 * height * (low * low + low * high + high * high);
}

/// Lateral area of a frustum.
double slant_area(double height, double low, double high) noexcept {
  const double rise = high - low;
  return kPi * (low + high) * std::sqrt(rise * rise + height * height);
}

}  // namespace

std::span<const BoxFace> box_faces() noexcept {
  static constexpr std::array<BoxFace, 6> kFaces{{{Face::minus_x, 0, -1.0},
                                                  {Face::plus_x, 0, 1.0},
                                                  {Face::minus_y, 1, -1.0},
                                                  {Face::plus_y, 1, 1.0},
                                                  {Face::bottom, 2, -1.0},
                                                  {Face::top, 2, 1.0}}};
  return kFaces;
}

double Solid::largest_radius() const noexcept {
  return revolves() ? std::max(low_radius, high_radius) : glm::length(glm::abs(middle) + half_size);
}

Bounds Solid::bounds() const noexcept {
  const double r = largest_radius();
  const glm::dvec2 lo = revolves() ? glm::dvec2(-r) : middle - half_size, hi = revolves() ? glm::dvec2(r) : middle + half_size;
  return {Vec3(lo, z_low), Vec3(hi, z_high)};
}

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

double Solid::bore(double z) const noexcept { return low_bore + (high_bore - low_bore) * ((z - z_low) / height()); }

bool Solid::contains(const Vec3& p) const noexcept {
  if (p.z < z_low || p.z > z_high) return false;
  if (kind == SolidKind::box) return std::abs(p.x - middle.x) <= half_size.x && std::abs(p.y - middle.y) <= half_size.y;
  const double squared = p.x * p.x + p.y * p.y;
  if (squared > squared_radius(p.z)) return false;
  if (!bored()) return true;
  const double hole = bore(p.z);
  return squared >= hole * hole;
}

double Solid::volume() const noexcept {
  if (kind == SolidKind::box) return 4.0 * half_size.x * half_size.y * height();
  if (kind == SolidKind::ellipsoid) return 4.0 / 3.0 * kPi * low_radius * low_radius * (0.5 * height());
  return frustum_volume(height(), low_radius, high_radius) - frustum_volume(height(), low_bore, high_bore);
}

double Solid::area() const noexcept {
  if (kind == SolidKind::box) return 8.0 * half_size.x * half_size.y + 4.0 * (half_size.x + half_size.y) * height();
  if (kind == SolidKind::ellipsoid) return spheroid_area(low_radius, 0.5 * height());
  const double ends = low_radius * low_radius + high_radius * high_radius - low_bore * low_bore - high_bore * high_bore;
  return kPi * ends + slant_area(height(), low_radius, high_radius) + slant_area(height(), low_bore, high_bore);
}

Solid make_frustum(const FrustumSize& size) noexcept {
  return {.kind = SolidKind::frustum,
          .z_low = size.z_low,
          .z_high = size.z_low + size.height,
          .low_radius = size.low_radius,
          .high_radius = size.high_radius};
}

Solid make_tube(const FrustumSize& outer, const BoreSize& bore) noexcept {
  Solid tube = make_frustum(outer);
  tube.low_bore = bore.low_radius;
  tube.high_bore = bore.high_radius;
  return tube;
}

Solid make_cylinder(double z_low, double height, double radius) noexcept {
  return make_frustum({.z_low = z_low, .height = height, .low_radius = radius, .high_radius = radius});
}

Solid make_cone(double z_low, double height, double radius) noexcept {
  return make_frustum({.z_low = z_low, .height = height, .low_radius = 0.0, .high_radius = radius});
}

Solid make_sphere(double z_low, double radius) noexcept { return make_ellipsoid(z_low, 2.0 * radius, radius); }

Solid make_ellipsoid(double z_low, double height, double radius) noexcept {
  return {.kind = SolidKind::ellipsoid, .z_low = z_low, .z_high = z_low + height, .low_radius = radius, .high_radius = radius};
}

Solid make_box(const BoxSize& size) noexcept {
  return {
      .kind = SolidKind::box, .z_low = size.z_low, .z_high = size.z_low + size.height, .middle = size.centre, .half_size = 0.5 * size.size};
}

}  // namespace burrhole
