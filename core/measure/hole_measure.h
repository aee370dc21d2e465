/// core/measure/hole_measure.h: what a run has drilled, measured on the 0.5 surface at its end. Bone that was gone before the run
///   (Voxmap::starts_drilled) is no part of it: "as loaded" below is the state before the run.
///   Frame  bone frame.   Units  SI.   Errors  none.   Thread  simulation (reads the voxmap).
#pragma once

#include <optional>

#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct HoleMeasure {
  double removed = 0.0;       ///< [m^3] volume lost inside the 0.5 surface
  double removed_mass = 0.0;  ///< [m^3] integral of the density lost: of occupancy x (1 - remaining)
  /// [m] diameter of the circle with the area of the hole in the outer surface as loaded; nothing below two voxel edges, as where a rim was shaved
  std::optional<double> outer_diameter;
  std::optional<double> inner_diameter;  ///< [m] the same for the inner surface; nothing if the hole does not reach it
};

/// Casts rays parallel to the approach axis, half a voxel apart, over the box of changed bone. The area of a ray counts as hole if the bone
/// half a voxel behind the first (inner surface: last) surface as loaded was there and is gone. The volume uses 4x4x4 trilinear samples per
/// voxel.
[[nodiscard]] HoleMeasure measure_hole(Voxmap& voxmap, const Approach& approach);

}  // namespace burrhole
