/// app/lab/drilling_cost.h: what each setting of a scene costs in accuracy and time when a hole is drilled: one setting at a time round the
///   defaults, holes through a plate by a bench and by the default hand (drilling_trial.h).
///   Units  in the names.   Errors  those of a trial; bad_input for an unknown bit or setting; unavailable without gnuplot.
///   Thread options.runs; figures are the same for any number, times are not.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/drilling_knobs.h"

namespace burrhole {

struct DrillingCostOptions {
  DrillingRuns runs;
  std::string bit = "flat 4 mm";             ///< cheap, and cuts alike all over
  std::shared_ptr<const DrillingBit> own{};  ///< DrillingTrial::own
  std::string only_knob{};                   ///< empty: all
  bool quick = false;                        ///< two values per setting, and no shifts
  int shifts = 3;                            ///< positions of the entry, 1 nm apart, over which the plunge is compared
};

/// One value of one setting. Errors are differences from the reference; NaN where one does not apply. An error against the finer run that is
/// smaller than that run's own (`own`) says that it is smaller, and no more.
struct DrillingPoint {
  std::string knob, unit, reference;  ///< of the knob; what the finer run and its second level are
  bool has_second = false;            ///< the reference has a second level
  double setting = 0.0;               ///< [unit]
  double shipped = 0.0;               ///< [unit] the default
  double volume_percent = 0.0;        ///< removed volume, from the closed form
  double mass_percent = 0.0;          ///< removed mass, from the closed form
  double outer_mm = 0.0;              ///< diameter of the hole outside, from the bit's
  double inner_mm = 0.0;              ///< the same inside
  double time_percent = 0.0;          ///< from contact to breakthrough, from the finer run
  double depth_mm = 0.0;              ///< of the tip at breakthrough, from the finer run
  double plunge_mm = 0.0;             ///< from the finer run
  double spread_mm = 0.0;             ///< of the plunge over the shifts
  double feed_percent = 0.0;          ///< on the bench, from the finer run
  double ripple_percent = 0.0;        ///< of that feed
  double roughness_um = 0.0;          ///< of the wall
  /// Of the finer run itself: its difference from a second one, half as fine (second_value()); NaN where there is none.
  struct Own {
    double time_percent = DrillingResult::kNone, depth_mm = DrillingResult::kNone, plunge_mm = DrillingResult::kNone,
           feed_percent = DrillingResult::kNone;
  } own{};
  double early_stops = 0.0;          ///< [-] runs of the default hand without a breakthrough
  double cpu_s = 0.0, wall_s = 0.0;  ///< of the run with the default hand
  double median_us = 0.0;            ///< CPU time of 100 ms of simulated time
  double p99_us = 0.0;               ///< the same
  double bytes = 0.0;                ///< [bytes] predicted peak of the process
};

/// A figure of a point, for tables.
struct DrillingFigure {
  const char* name;
  const char* unit;
  const char* reference;                      ///< null: the finer run of the knob
  double DrillingPoint::*value;               ///< [unit]
  double DrillingPoint::Own::*own = nullptr;  ///< [unit] of the finer run itself; null: not against a finer run
};
[[nodiscard]] std::span<const DrillingFigure> drilling_figures() noexcept;

/// @returns the points, knob by knob, settings in the order of the knob.
[[nodiscard]] Result<std::vector<DrillingPoint>> measure_drilling_cost(const DrillingCostOptions& options);

/// @returns a row per point and figure.
[[nodiscard]] std::vector<CostRow> drilling_cost_rows(const std::vector<DrillingPoint>& points, const std::string& bit);
/// @returns one sentence per knob, made from its points.
[[nodiscard]] std::vector<std::string> drilling_sentences(const std::vector<DrillingPoint>& points);
/// Writes cost.csv, drilling.md, drilling.svg and drilling.html into a folder. `unavailable` without gnuplot: the first two are written.
[[nodiscard]] Status write_drilling_cost(const std::vector<DrillingPoint>& points, const std::string& bit, const std::string& folder);

}  // namespace burrhole
