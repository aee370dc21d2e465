/// app/engine/hole_measure.h: the hole that was made, measured on the 0.5 surface at the end of a run.
#pragma once

#include <optional>

#include "app/engine/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct HoleMeasure {
  double removed = 0.0;                  ///< [m^3] loss of volume inside the 0.5 surface
  std::optional<double> outer_diameter;  ///< [m] of the circle with the hole's area in the outer surface as loaded
  std::optional<double> inner_diameter;  ///< [m] likewise in the inner surface; nothing when the hole does not reach it
};

/// Rays parallel to the approach axis, half a voxel apart, over the box of changed bone: where a ray met the outer (last: the inner)
/// surface as loaded, the area counts when the bone half a voxel behind that surface is gone. Volume by 4x4x4 trilinear samples a voxel.
[[nodiscard]] HoleMeasure measure_hole(Voxmap& voxmap, const Approach& approach);

}  // namespace burrhole
