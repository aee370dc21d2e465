#include "app/lab/oracle/drilled_volume.h"

#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

/// Area [m^2] of the part of a circle round the origin with x < inset.
double area_inside(double radius, double inset) noexcept {
  if (inset >= radius) return std::numbers::pi * radius * radius;
  if (inset <= -radius) return 0.0;
  const double height = std::sqrt(radius * radius - inset * inset);
  // The sector over the arc with x < inset, and the triangle between its chord and the centre.
  return radius * radius * (std::numbers::pi - std::acos(inset / radius)) + inset * height;
}

/// Volume [m^3] of a ball of radius `ball` above the equatorial plane and within `radius` of the axis: the integral of
/// 2 pi r sqrt(ball^2 - r^2).
double under_dome(double ball, double radius) noexcept {
  const double rim = ball * ball - radius * radius;
  return 2.0 * std::numbers::pi / 3.0 * (ball * ball * ball - rim * std::sqrt(rim));
}

}  // namespace

double through_plate(const SweptBit& bit, double thickness) noexcept {
  return std::numbers::pi * (bit.radius * bit.radius - bit.bore * bit.bore) * thickness;
}

double through_edge(const SweptBit& bit, double thickness, double inset) noexcept {
  return (area_inside(bit.radius, inset) - (bit.bore > 0.0 ? area_inside(bit.bore, inset) : 0.0)) * thickness;
}

double through_shell(const SweptBit& bit, double thickness, double curvature) noexcept {
  const auto within = [&](double radius) { return under_dome(curvature, radius) - under_dome(curvature - thickness, radius); };
  return within(bit.radius) - within(bit.bore);
}

}  // namespace burrhole
