/// app/lab/multirate.h: accuracy and cost of contact slower than the servo: for each multi-rate scheme and contact rate, the error of the
///   force relative to a loop of servo and contact at 4 kHz, the share of the stable stiffness that is kept, and the cost of a servo step.
///   Units as the rows state.   Errors  those of a run; unavailable without gnuplot.   Thread one, so that times are not disturbed.
///   Force   for a hand that follows a fixed path independent of the force, so that all loops have the same input: sliding to and fro over
///   a
///           sphere of the tool's radius, and a feed into it with the spindle on. The reference evaluates contact every tick of a servo at 4 kHz.
///   Stiffness  as frontier_search.h: the generic device in the nominal hand, released half pressed onto that sphere, at rest and drilling.
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/study.h"
#include "haptics/servo/multi_rate.h"

namespace burrhole {

struct MultirateOptions {
  std::vector<int> contact_ticks{1, 2, 5, 10, 20, 50};  ///< [ticks] of a 1 kHz servo; the first must be 1
  double stiffness = 5000.0;                            ///< [N/m] of the coupling in the force comparison: the default of a scene
  bool limits = true;                                   ///< also measures the stable stiffness, which takes most of the time
  Study* study = nullptr;                               ///< runs the trials; null: nothing is kept
};
[[nodiscard]] std::size_t count_of_trials(const MultirateOptions& options);

/// Rows of cost.csv against the contact rate [Hz]: force_rms_off and force_worst_off [% of the reference's mean force], with the times of
/// the servo step; stiffness_kept [-] relative to the same scheme at 1 kHz.
[[nodiscard]] Result<std::vector<CostRow>> measure_multirate(const MultirateOptions& options);

/// Writes cost.csv, multirate.svg and multirate.html into a folder. `unavailable` without gnuplot: the CSV is written.
[[nodiscard]] Status write_multirate(const std::vector<CostRow>& rows, const std::string& folder);

}  // namespace burrhole
