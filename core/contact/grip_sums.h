/// core/contact/grip_sums.h: what the engaged points of a tool have in common, summed for side_grip.h.
///   Frame  tool.   Units  SI.   Thread  contact; never allocates.
///   Source own derivation. Points are summed in their order, in double precision: the bits of a plain loop on every SIMD level.
#pragma once

#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Three directions at right angles, unit.
struct GripAxes {
  Vec3 push, u, v;
};

/// Sums over points; the load of one is the square of its inward normal's part along the push.
struct GripSums {
  double along = 0.0;                   ///< of load
  Vec3 middle{0.0};                     ///< of load times place [m]
  double spread = 0.0;                  ///< of load times squared distance from the push's line through the origin [m^2]
  double uu = 0.0, uv = 0.0, vv = 0.0;  ///< of products of the inward normal's parts along u and v
};

/// Over the hits under the surface whose inward normals have `least` and more along the push.
[[nodiscard]] GripSums sum_grip(const ProbeHits& inside, const PointShell& shell, const GripAxes& axes, double least) noexcept;

}  // namespace burrhole
