/// app/lab/drilling_convergence.h: does the drilled hole depend on the discretisation? Holes of six bits in three bones by two laws, at several
///   voxel edges and erosion rates, one factor at a time round the defaults and at seeded corners, against the closed form or the finest run.
///   Units  as the measures say.   Errors  those of a trial.   Thread  options.runs; results are the same for any number.
///   Bounds volume and mass 3 %, time from contact to breakthrough 5 %, plunge 0.1 mm + 0.25 voxel; no run stops early.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/lab/drilling_trial.h"
#include "app/lab/stability_run.h"

namespace burrhole {

/// One point. What is absent takes the default of a scene.
struct DrillingSetting {
  std::string bit;
  DrillingBone bone = DrillingBone::plate;
  std::optional<std::string> law{};
  std::optional<double> spacing_mm{};
  std::optional<int> erosion_hz{};
  friend bool operator==(const DrillingSetting&, const DrillingSetting&) = default;
};

struct ConvergenceOptions {
  DrillingRuns runs;
  bool quick = false;      ///< a subset for continuous integration
  std::uint64_t seed = 1;  ///< of the corners
  int corners = 12;
  std::vector<std::string> sabotage{};  ///< "table.key=value" in every scene, so that bounds must fail
};

/// @returns the points: the defaults, one factor at a time, then the corners; settings that are defaults are absent.
[[nodiscard]] Result<std::vector<DrillingSetting>> convergence_settings(const ConvergenceOptions& options);
[[nodiscard]] std::string name_of(const DrillingSetting& setting);

/// @returns a row per point and measure: volume_off_percent and mass_off_percent (of a hole that the bit has passed; the smaller of the
/// differences from the closed form and from the finest run), time_off_percent and plunge_off_mm (from the finest run), early_stops; and
/// time_not_falling, the number of erosion factors of the stepped bit from 0.02 to 0.1 with which it was no faster than with the last.
[[nodiscard]] Result<std::vector<StabilityRow>> measure_convergence(const ConvergenceOptions& options);

[[nodiscard]] bool convergence_failed(const std::vector<StabilityRow>& rows);
/// Writes convergence.csv, convergence.md and convergence.html into a folder.
[[nodiscard]] Status write_convergence(const std::vector<StabilityRow>& rows, const std::string& folder);

}  // namespace burrhole
