/// app/lab/stability_run.h: runs hard cases on the shipped path (scene text -> load_scene -> Stage -> Lockstep), tick by tick, and
///   evaluates them.   Units  in the names.   Errors  bad_input, errors of the scene.   Thread  one per case; cases share nothing.
#pragma once

#include <atomic>
#include <functional>

#include "app/lab/stability_case.h"
#include "core/base/result.h"

namespace burrhole {

/// One row of stability.csv.
struct StabilityRow {
  std::string subject;  ///< name of the case
  std::string model;
  std::string measure;
  double value = 0.0, bound = 0.0;  ///< [unit of the measure]
  bool pass = false;
};

/// Result of a case with one model.
struct StabilityOutcome {
  std::string subject{}, model{};
  std::vector<StabilityRow> rows{};                     ///< in the order of the checks of the case
  std::vector<double> time_s{}, force_N{}, depth_mm{};  ///< [s], [N], [mm] decimated, for the picture
  double points = 0.0;                                  ///< [-] number of shell points
  std::string error{};                                  ///< why the case could not run; rows are then empty
};

/// @param sabotaged applies the sabotage of the case.
[[nodiscard]] StabilityOutcome run_stability_case(const StabilityCase& of, const StabilityModel& model, bool sabotaged);
/// @returns the trace of a whole run, for tests, or errors of the scene.
[[nodiscard]] Result<StabilityTrace> trace_of(const StabilityCase& of, const StabilityModel& model, bool sabotaged);

struct StabilityOptions {
  std::string only_case, only_model;  ///< empty: all
  bool long_runs = false;
  bool sabotage = false;  ///< runs each case with its sabotage and the default model; the named measure is then expected to fail
  unsigned threads = 0;   ///< 0: one per core
};
/// @returns all cases with every model, in fixed order for any number of threads; bad_input for an unknown case or model.
/// @param progress called from any thread, one at a time, with the share done and the last case.
[[nodiscard]] Result<std::vector<StabilityOutcome>> run_stability(const StabilityOptions& options,
                                                                  const std::function<void(double, const std::string&)>& progress);

}  // namespace burrhole
