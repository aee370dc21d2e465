/// app/lab/surface_accuracy.h: what the bits and the pitch of surface records cost: how far the felt surface is from the true one, and how
///   long a look-up takes. Records come from the shipped voxmap and window, look-ups from the shipped probe.
///   Frame  world = bone frame.   Units  SI here; rows name theirs.   Reference  the phantom's closed form.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "core/base/result.h"

namespace burrhole {

struct SurfaceAccuracyOptions {
  std::vector<double> pitches{0.5e-3, 0.35e-3, 0.25e-3, 0.18e-3};  ///< [m] of the voxels
  std::size_t points = 5800;                                       ///< looked up at once, as of a tool's shell
  int repeats = 401;                                               ///< timed look-ups of all points: four lie above the p99
  std::uint64_t seed = 1;                                          ///< of the places
};

/// For each shape (tilted plate, ball of 4 mm, skull patch), bits and pitch, over places within a voxel of the surface:
///   distance_median, distance_worst [voxel], normal_median, normal_worst [deg]; bytes: of a voxel's record; times: of a call, which
///   looks all of them up. Edges of the patch are left out. Faults of phantoms pass through.
[[nodiscard]] Result<std::vector<CostRow>> measure_surface_accuracy(const SurfaceAccuracyOptions& options);

/// cost.csv and surface_error.svg in a folder. `unavailable` without gnuplot (the table is then written).
[[nodiscard]] Status write_surface_accuracy(const std::vector<CostRow>& rows, const std::string& folder);

}  // namespace burrhole
