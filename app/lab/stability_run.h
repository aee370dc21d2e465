/// app/lab/stability_run.h: runs a hard case on the shipped path: scene text -> load_scene -> DrillParts -> Lockstep, tick by tick, and
///   judges it. Thread  one a case; cases share nothing.
#pragma once

#include <atomic>
#include <functional>

#include "app/lab/stability_case.h"
#include "core/base/result.h"

namespace burrhole {

/// One line of stability.csv.
struct StabilityRow {
  std::string subject;  ///< case
  std::string model;
  std::string measure;
  double value = 0.0, bound = 0.0;
  bool pass = false;
};

/// A case felt by one model.
struct StabilityOutcome {
  std::string subject{}, model{};
  std::vector<StabilityRow> rows{};                     ///< in the order of the case's checks
  std::vector<double> time_s{}, force_N{}, depth_mm{};  ///< for the picture: what fits into it
  double points = 0.0;                                  ///< of the shell
  std::string error{};                                  ///< what kept it from running; rows are then empty
};

/// @param sabotaged as the case's sabotage breaks it.
[[nodiscard]] StabilityOutcome run_stability_case(const StabilityCase& of, const StabilityModel& model, bool sabotaged);
/// The trace of a whole run, for tests. Errors of the scene pass through.
[[nodiscard]] Result<StabilityTrace> trace_of(const StabilityCase& of, const StabilityModel& model, bool sabotaged);

struct StabilityOptions {
  std::string only_case, only_model;  ///< empty: all
  bool long_runs = false;
  bool sabotage = false;  ///< each case broken as it says, default model; the measure it names is then expected to fail
  unsigned threads = 0;   ///< 0: as many as the machine has
};
/// All cases, each for every model, in fixed order whatever the threads. bad_input for a case or model that there is not.
/// @param progress from any thread, one at a time: share done and what was done last.
[[nodiscard]] Result<std::vector<StabilityOutcome>> run_stability(const StabilityOptions& options,
                                                                  const std::function<void(double, const std::string&)>& progress);

}  // namespace burrhole
