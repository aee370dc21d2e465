#include "tests/core/drill/swept_solid.h"

#include <cmath>
#include <numbers>

namespace burrhole::test {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

ErosionPoints SweptSolid::points(double pitch, float factor) const {
  return ball ? lattice(Ball{radius}, pitch, factor) : lattice(Cylinder{radius, height}, pitch, factor);
}

double SweptSolid::distance(const Vec3& p, double inset) const {
  const Affine tool_from_index = from.inverse();
  const auto at = [&](double t) {
    const Vec3 q = tool_from_index * (p - way * t);  // [m]
    const double gone = inset * voxel;
    if (ball) return std::max(0.0, glm::length(q - Vec3(0.0, 0.0, radius)) - (radius - gone)) / voxel;
    const double radial = std::max(0.0, std::sqrt(q.x * q.x + q.y * q.y) - (radius - gone));
    const double axial = std::max(0.0, std::abs(q.z - 0.5 * height) - (0.5 * height - gone));
    return std::sqrt(radial * radial + axial * axial) / voxel;
  };
  // The distance to a convex solid is convex along the way: golden section finds its least value.
  double lo = 0.0, hi = 1.0;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double least = std::min(at(0.0), at(1.0));
  for (int n = 0; n < 45 && least > 0.0; ++n) {
    const double a = hi - golden * (hi - lo), b = lo + golden * (hi - lo);
    const double at_a = at(a), at_b = at(b);
    least = std::min({least, at_a, at_b});
    if (at_a < at_b)
      hi = b;
    else
      lo = a;
  }
  return least;
}

bool SweptSolid::surely_outside(const Vec3& p) const {
  const double half_height = ball ? radius : 0.5 * height;
  const Vec3 middle = from * Vec3(0.0, 0.0, half_height) + 0.5 * way;
  return glm::length(p - middle) > 0.5 * glm::length(way) + std::hypot(radius, half_height) / voxel;
}

double SweptSolid::volume() const {
  const double r = radius / voxel, h = height / voxel, length = glm::length(way);
  if (ball) return kPi * r * r * length + 4.0 / 3.0 * kPi * r * r * r;
  const Vec3 axis = glm::normalize(from.linear[2]);
  const double along = length > 0.0 ? std::abs(glm::dot(axis, way / length)) : 0.0;
  const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
  return kPi * r * r * h + length * (kPi * r * r * along + 2.0 * r * h * across);
}

}  // namespace burrhole::test
