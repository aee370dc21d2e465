/// core/contact/flank_sums.h: sums over the engaged points of a tool, for the lateral stiffness of flank_friction.h.
///   Frame  tool.   Units  SI.   Thread  contact; never allocates.
///   Source own derivation. Points are summed in their order, in double precision: every SIMD level gives the bits of a scalar loop.
#pragma once

#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"

namespace burrhole {

/// [-] Three orthogonal unit vectors.
struct FlankAxes {
  Vec3 push, u, v;  ///< [-]
};

/// Sums over points. The load of a point is the squared component of its inward normal along the push.
struct FlankSums {
  double along = 0.0;                   ///< [-] sum of load
  Vec3 middle{0.0};                     ///< [m] sum of load * position
  double spread = 0.0;                  ///< [m^2] sum of load * squared distance from the line through the origin along the push
  double uu = 0.0, uv = 0.0, vv = 0.0;  ///< [-] sums of products of the inward normal's components along u and v
};

/// Sums over the hits below the surface whose inward normals have a component of at least `least` along the push.
[[nodiscard]] FlankSums sum_flanks(const ProbeHits& inside, const PointShell& shell, const FlankAxes& axes, double least) noexcept;

}  // namespace burrhole
