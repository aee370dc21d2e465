/// volumes/phantom/head_shape.h: a skull of anatomical size as an implicit solid: smooth unions and cuts of ellipsoids and rounded cones.
///   Frame   bone frame of a head, LPS: origin midway between the ears, +x to the left, +y to the back, +z up; the Frankfurt plane is z = 0.
///   Units   SI; the numbers of head_shape.cpp are in mm.   Errors  none.   Thread  any; immutable.
///   Fields  0 on a surface, negative inside, with a gradient of about 1 there. They are not exact distances: divided by the length of the
///           gradient they are exact to first order.
///   Source  own shape. Size of the vault: length 180, breadth 145, height from the ears 115 mm, about the means of adults (assumed); the
///           position of each part is assumed from the proportions of skulls.
#pragma once

#include "core/base/bounds.h"
#include "core/base/geometry.h"

namespace burrhole {

/// A field and its gradient.
struct HeadField {
  double value = 0.0;  ///< [m]
  Vec3 slope{0.0};     ///< [-] about the gradient: that of the parts, without sutures and teeth; some degrees off where parts blend
};

/// The fields at a point.
struct HeadFields {
  HeadField bone;      ///< vault with its sutures, face and lower jaw, less their cavities
  HeadField cavity;    ///< that of the brain; its surface is the inner surface of the vault
  double outer = 0.0;  ///< [m] the vault's outer surface without sutures, with eye sockets and nose; the layers of bone lie below it
};

class HeadShape {
 public:
  /// @param thickness [m] of the vault, > 0.
  explicit HeadShape(double thickness) : thickness_(1e3 * thickness) {}

  [[nodiscard]] HeadFields at(const Vec3& p) const noexcept;
  [[nodiscard]] static HeadField vault(const Vec3& p) noexcept;
  /// @returns a smooth solid [m] that holds the skull, without details: what a cloth lies on; positive outside.
  [[nodiscard]] static double hull(const Vec3& p) noexcept;
  /// @returns the skin [m], positive outside: scalp of 5.5 mm over the vault, a simplified face with closed eyes, ears and a short neck. Thickness
  /// and shape are assumed; the skull lies at least 1 mm inside.
  [[nodiscard]] static double skin(const Vec3& p) noexcept;
  [[nodiscard]] static Bounds skin_box() noexcept;  ///< [m] round the skin
  /// @returns the furthest distance [m] of the skull from the origin along a direction of length 1: an upper bound.
  [[nodiscard]] static double reach(const Vec3& direction) noexcept;

 private:
  double thickness_;  // [mm]
};

}  // namespace burrhole
