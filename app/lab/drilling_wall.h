/// app/lab/drilling_wall.h: roughness of the wall of a drilled hole, measured on the 0.5 surface at the end of a run.
///   Frame  approach frame.   Units  SI.   Errors  none.   Thread  simulation (reads the voxmap).
#pragma once

#include <optional>

#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// The part of the wall that is measured.
struct WallBand {
  double from = 0.0, to = 0.0;  ///< [m] depth below the entry
  double radius = 0.0;          ///< [m] expected; the wall is searched from 1 mm beyond it inwards
};

/// Rq, as in surface metrology: the root mean square deviation of the wall's radius from a cylinder fitted to it, whose axis may be displaced
/// and tilted and whose radius may grow with depth. 72 azimuths at 12 depths, all in the hole.
/// @returns [m]; nothing if the wall is not closed all round.
[[nodiscard]] std::optional<double> wall_roughness(const Voxmap& voxmap, const Approach& approach, const WallBand& band);

}  // namespace burrhole
