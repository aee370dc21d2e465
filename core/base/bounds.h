/// core/base/bounds.h: axis-aligned boxes of real coordinates, and the eight corners of a box or of a cell.
///   Corner n, 0..7   bit 0 of n takes x from the upper end, bit 1 y, bit 2 z.   Units, frame: those of the values.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "core/base/geometry.h"

namespace burrhole {

/// Offset of corner n of a cell of eight voxels from its lowest one.
[[nodiscard]] constexpr Vec3i cell_corner(unsigned n) noexcept {
  return {static_cast<int>(n & 1u), static_cast<int>((n >> 1) & 1u), static_cast<int>(n >> 2)};
}

/// lo <= p <= hi on every axis.
struct Bounds {
  Vec3 lo{0.0}, hi{0.0};  ///< [unit of the points]

  [[nodiscard]] Vec3 corner(unsigned n) const noexcept {
    return {(n & 1u) != 0 ? hi.x : lo.x, (n & 2u) != 0 ? hi.y : lo.y, (n & 4u) != 0 ? hi.z : lo.z};
  }
  [[nodiscard]] std::array<Vec3, 8> corners() const noexcept {
    std::array<Vec3, 8> out;
    for (unsigned n = 0; n < 8; ++n) out[n] = corner(n);
    return out;
  }
  void include(const Vec3& p) noexcept {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  /// Holds nothing until a point is included.
  [[nodiscard]] static Bounds none() noexcept {
    const Vec3 far(std::numeric_limits<double>::infinity());
    return {far, -far};
  }
};

/// @param points at least one
[[nodiscard]] inline Bounds bounds_of_points(std::span<const Vec3> points) noexcept {
  Bounds out = Bounds::none();
  for (const Vec3& p : points) out.include(p);
  return out;
}

/// Bounds of a box that an affine map or a pose has turned: those of its corners.
template <class Map>
[[nodiscard]] Bounds bounds_under(const Map& map, const Bounds& box) noexcept {
  Bounds out = Bounds::none();
  for (const Vec3& corner : box.corners()) out.include(map * corner);
  return out;
}

}  // namespace burrhole
