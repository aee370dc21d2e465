/// volumes/phantom/head_solids.h: the solids of which skull and skin of a head are made, and how they are joined. Internal to volumes/phantom.
///   Frame  as head_shape.h.   Units  mm.   Errors  none.   Source  ellipsoids, cones and smooth minimum after I. Quilez; own derivation.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/geometry.h"

namespace burrhole::head_solids {

/// A field and about its gradient: HeadField in mm.
struct Solid {
  double v;  ///< [mm]
  Vec3 n;    ///< [-]
};

/// f / |grad f| of f = |q / radii| - 1: 0 on the ellipsoid, where its gradient is 1.
inline Solid ellipsoid(const Vec3& q, const Vec3& radii) noexcept {
  const Vec3 inverse = 1.0 / radii;
  const Vec3 s = q * inverse;
  const double k0 = std::sqrt(glm::dot(s, s));
  if (k0 < 1e-6) return {-std::min({radii.x, radii.y, radii.z}), Vec3(0, 0, 1)};
  const Vec3 along = s * inverse;
  const double scale = 1.0 / std::sqrt(glm::dot(along, along));
  return {(k0 - 1.0) * k0 * scale, along * scale};
}

/// A cone with round ends, about: the distance from the axis less a radius that is linear along it.
inline Solid cone(const Vec3& p, const Vec3& a, const Vec3& b, double radius_a, double radius_b) noexcept {
  const Vec3 ab = b - a;
  const double t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
  const Vec3 off = p - a - t * ab;
  const double r = std::sqrt(glm::dot(off, off));
  return {r - (radius_a + t * (radius_b - radius_a)), off / std::max(r, 1e-9)};
}

/// The smaller of two, rounded where they differ by less than `width` (polynomial smooth minimum). The derivative by h is 0, so the gradient
/// is the mean of theirs.
inline Solid unite(const Solid& a, const Solid& b, double width) noexcept {
  const double h = 0.5 + 0.5 * (b.v - a.v) / width;
  if (h >= 1.0) return a;
  if (h <= 0.0) return b;
  return {b.v + h * (a.v - b.v) - width * h * (1.0 - h), b.n + h * (a.n - b.n)};
}
inline Solid inverted(const Solid& s) noexcept { return {-s.v, -s.n}; }
inline Solid cut(const Solid& solid, const Solid& hole, double width) noexcept { return inverted(unite(inverted(solid), hole, width)); }
inline Solid grown(const Solid& s, double by) noexcept { return {s.v - by, s.n}; }

inline double smooth_step(double from, double to, double x) noexcept {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Reflects x to the left side.
struct Fold {
  Vec3 q;       ///< [mm]
  double sign;  ///< [-] of x
  explicit Fold(const Vec3& p) noexcept : q(std::abs(p.x), p.y, p.z), sign(p.x < 0.0 ? -1.0 : 1.0) {}
  [[nodiscard]] Solid operator()(Solid s) const noexcept {
    s.n.x *= sign;
    return s;
  }
};

[[nodiscard]] Solid vault_of(const Vec3& p) noexcept;

}  // namespace burrhole::head_solids
