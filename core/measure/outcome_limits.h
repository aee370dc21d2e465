/// core/measure/outcome_limits.h: thresholds by which the result of a run is judged (outcome.h).
///   Units  in the names of the members.   Frame  none.   Errors  none.   Thread  any.
#pragma once

namespace burrhole {

/// Thresholds of the criteria. The values are definitions, except where a source is named.
struct OutcomeLimits {
  /// [mm] The dura is 0.3 to 0.8 mm thick; half a millimetre of it is strained or torn.   key [outcome] plunge_limit_mm
  double plunge_mm = 0.5;
  double through_share = 0.5;    ///< [-] of the cross-section
  double whole_share = 0.9;      ///< [-] of the cross-section: at least this much leaves no shelf
  double uncut_share = 0.5;      ///< [-] of the columns that the bit passed
  double cut_depth_mm = 0.1;     ///< removed bone over the area of the cross-section
  double aside_mm = 1.0;         ///< least distance from the axis that counts as skating, whatever the radius of the bit
  double missed_share = 0.01;    ///< [-] of the steps of a clock: no time of the run is then known better than to 1 %
  double degraded_share = 0.01;  ///< [-] of the evaluations of contact; single ones are usual where a bit lands on a ledge
};

}  // namespace burrhole
