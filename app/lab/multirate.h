/// app/lab/multirate.h: the price of contact that is slower than the servo: for each multi-rate scheme and contact rate, how far the force
///   is off that of the 1 kHz loop, how much of the stable stiffness is kept, and what a servo step costs.
///   Units as the rows name them.   Thread one, so that times are of a machine that does nothing else of ours.
///   Force   a hand that follows a given path (nothing moves it), so that all loops are asked the same: a slide to and fro over a sphere of
///           the tool's radius, and a feed into it with the spindle on. The reference is the loop whose contact looks every servo tick.
///   Stiffness  as frontier_search.h: the generic device in the nominal hand, let go half pressed onto that sphere, still and drilling.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "haptics/servo/multi_rate.h"

namespace burrhole {

struct MultirateOptions {
  std::vector<int> contact_ticks{1, 2, 5, 10, 20, 50};  ///< of a 1 kHz servo, the first 1
  double stiffness = 5000.0;                            ///< [N/m] of the coupling where the force is compared: a scene's default
  bool limits = true;                                   ///< also what stiffness is kept, which takes most of the time
  std::function<void(double)> progress;                 ///< share done 0..1; may be empty
};

/// Rows of cost.csv against the contact rate [Hz]: force_rms_off and force_worst_off [% of the reference's mean force], with the servo
/// step's times; stiffness_kept [-] of the same scheme's at 1 kHz.
[[nodiscard]] Result<std::vector<CostRow>> measure_multirate(const MultirateOptions& options);

/// cost.csv, multirate.svg and multirate.html into a folder. `unavailable` without gnuplot: the CSV is then there.
[[nodiscard]] Status write_multirate(const std::vector<CostRow>& rows, const std::string& folder);

}  // namespace burrhole
