/// app/lab/effects_accuracy.h: what the accuracy of an effect costs: the keys that it names (app/stage/accuracy.h), each from coarse to fine, with
///   the error of its figures against a finer run, the time of its steps and its memory. Three keys act on every effect: the edge of the voxels,
///   and those that are marked so.
///   Units  in the names.   Errors  those of the scene and of a study.   Thread  one; times as TrialRun::step_ms().
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/effects_trial.h"
#include "app/lab/study.h"
#include "app/report/plot.h"
#include "app/stage/accuracy.h"

namespace burrhole {

/// What one effect gives in one run.
struct LadderRun {
  double setting = 0.0;         ///< [unit of the key]
  double multiple = 0.0;        ///< [-] of the scene's own value
  double time_ms = 0.0;         ///< [ms] of its steps, for a simulated second
  double bytes = 0.0;           ///< [bytes]
  std::vector<double> figures;  ///< [units of the figures] in the order of Ladder::figures; NaN: the run has none
};

/// One key at several values, as one effect sees it.
struct Ladder {
  std::string table;                    ///< of the effect
  std::string knob;                     ///< "table.key"; empty: the scene cannot be drilled with the effect, `refused` says why
  bool general = false;                 ///< the key acts on every effect
  std::vector<AccuracyFigure> figures;  ///< of the effect
  std::vector<LadderRun> runs;          ///< coarse to fine; one has the multiple 1; none without a run of the reference
  LadderRun reference;
  std::vector<std::string> along;    ///< keys that are changed with it
  std::vector<std::string> refused;  ///< a line for each value with which the scene cannot be drilled
};

enum class LadderTrend {
  none,        ///< no run has the figure
  unaffected,  ///< all runs have the figure of the reference: the key does not act on it
  falls,  ///< finer values have less error: no step adds more than kLadderFloor, and the finest has at most kLadderFall of the coarsest
  stays   ///< it does not approach the reference
};
inline constexpr double kLadderFloor = 0.01;  ///< [-] of errors; less does not count
inline constexpr double kLadderFall = 0.75;   ///< [-] of the error of the coarsest value

struct FigureErrors {
  std::vector<double> errors;  ///< [-] of the reference, in the order of Ladder::runs; NaN: one of the two has no figure
  /// [-] error of the reference itself, if errors are in proportion to the key: from the finest run and the ratio of both values.
  double own = 0.0;
  LadderTrend trend = LadderTrend::none;
};

/// @returns the errors of each figure.
[[nodiscard]] std::vector<FigureErrors> ladder_errors(const Ladder& ladder);
/// @returns whether the key changes any figure of the effect.
[[nodiscard]] bool has_effect(const std::vector<FigureErrors>& errors) noexcept;
[[nodiscard]] const LadderRun& usual_run(const Ladder& ladder) noexcept;

/// @param only tables of the effects that are measured; empty: all.
[[nodiscard]] Result<std::vector<Ladder>> measure_ladders(const TrialScene& scene, const std::vector<std::string>& only,
                                                          const StudyRuns& runs);

/// @returns a row for each key, value and figure; `median_us` is the time of the effect's steps in a simulated second.
[[nodiscard]] std::vector<CostRow> ladder_rows(const std::vector<Ladder>& ladders);
[[nodiscard]] std::vector<std::string> ladder_heads();
/// @returns a row for each key and value, under ladder_heads().
[[nodiscard]] std::vector<std::vector<std::string>> ladder_cells(const std::vector<Ladder>& ladders);
/// @returns a line for each key of which the value of the scene has an error above 3 %, that does not converge, or that changes nothing.
[[nodiscard]] std::vector<std::string> ladder_notes(const std::vector<Ladder>& ladders);
/// @returns error against time: a panel for each key that one effect has, with a curve for each figure.
[[nodiscard]] Plot ladder_plot(const std::vector<Ladder>& ladders);
/// @returns error against time: a panel for each effect, with a curve for each key that acts on all; of its first figure.
[[nodiscard]] Plot general_ladder_plot(const std::vector<Ladder>& ladders);

}  // namespace burrhole
