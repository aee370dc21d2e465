/// app/lab/surface_accuracy.h: accuracy and cost of surface records by bits and pitch: error of the felt surface, and duration of a query.
///   Records come from the shipped voxmap and window, queries use the shipped probe.
///   Frame  world = bone frame.   Units  SI here; rows state theirs.   Errors  those of phantoms; unavailable without gnuplot.
///   Reference  closed form of the phantom.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/study.h"
#include "core/base/result.h"

namespace burrhole {

struct SurfaceAccuracyOptions {
  std::vector<double> pitches{0.5e-3, 0.35e-3, 0.25e-3, 0.18e-3};  ///< [m] voxel edges
  std::size_t points = 5800;                                       ///< queried together, as by a tool's shell
  int repeats = 401;                                               ///< timed queries of all points: four are above the p99
  std::uint64_t seed = 1;                                          ///< of the positions
  Study* study = nullptr;                                          ///< runs the trials; null: nothing is kept
};
[[nodiscard]] std::size_t count_of_trials(const SurfaceAccuracyOptions& options);

/// For each shape (tilted plate, ball of 4 mm, skull patch), bits and pitch, over positions within a voxel of the surface:
///   distance_median, distance_worst [voxel], normal_median, normal_worst [deg]; bytes: of a voxel's record; times: of a call that queries
///   all positions. Edges of the patch are excluded. Errors of phantoms are returned.
[[nodiscard]] Result<std::vector<CostRow>> measure_surface_accuracy(const SurfaceAccuracyOptions& options);

/// Writes cost.csv and surface_error.svg into a folder. `unavailable` without gnuplot (the table is written).
[[nodiscard]] Status write_surface_accuracy(const std::vector<CostRow>& rows, const std::string& folder);

}  // namespace burrhole
