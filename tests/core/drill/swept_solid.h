/// tests/core/drill/swept_solid.h: closed forms of a ball and a cylinder pushed along a straight line.
#pragma once

#include "tests/core/drill/drill_cases.h"

namespace burrhole::test {

/// A solid of revolution in its tool frame [m], on a straight way without turning. Distances and volumes come in voxels.
struct SweptSolid {
  bool ball = true;     ///< otherwise a cylinder
  double radius = 1.0;  ///< [m]
  double height = 1.0;  ///< [m] of the cylinder
  double voxel = 1.0;   ///< [m]
  Affine from{};        ///< index_from_tool at the start
  Vec3 way{0.0};        ///< [voxels]

  [[nodiscard]] ErosionPoints points(double pitch, float factor) const;
  [[nodiscard]] ErosionPath path() const { return {from, moved(from, way)}; }
  /// Distance of an index point to the swept solid eroded by `inset` [voxels]; 0 inside.
  [[nodiscard]] double distance(const Vec3& p, double inset) const;
  /// True outside a ball round the whole swept solid: a cheap first question.
  [[nodiscard]] bool surely_outside(const Vec3& p) const;
  /// Convex body, so volume + way x projected area [voxels^3].
  [[nodiscard]] double volume() const;
};

}  // namespace burrhole::test
