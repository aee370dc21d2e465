/// app/lab/effects_cost.h: what each effect costs: a scene drilled with and without it, with each of its keys at half and at twice its default,
///   and with the keys that trade time for accuracy from coarse to fine (effects_accuracy.h).
///   Effects are those of the registry, so that a new one is measured too. Runs are in lockstep, as `burrhole drill` does them, without pictures.
///   Units   in the names.   Errors   those of the scene and of a study; unavailable without gnuplot.
///   Thread  one; times are CPU times of this thread, medians of runs that take turns with those of the scene as it is.
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/effects_accuracy.h"
#include "app/lab/effects_trial.h"
#include "app/lab/study.h"

namespace burrhole {

/// One run of the scene.
struct EffectRun {
  double cpu_ms = 0.0;  ///< [ms] of CPU time for a simulated second; median
  double bytes = 0.0;   ///< [bytes] that the effect reports or predicts
  std::string bits;     ///< hash of bone and forces
  RunFigures figures;   ///< of the run, then of the effect
};

struct EffectPrice {
  std::string table;
  bool named = false;                  ///< the scene names it: `other` is the scene without it; otherwise the scene with it
  std::vector<std::string> requiring;  ///< tables of the scene that require it: `other` is without them too
  std::string given;                   ///< the lines of the table that were added, or "as in the scene"
  std::string refused;                 ///< why the scene cannot be drilled so; empty: it can
  EffectRun scene, other;              ///< as it is; with the effect, or without it
  [[nodiscard]] double added_ms() const noexcept { return named ? scene.cpu_ms - other.cpu_ms : other.cpu_ms - scene.cpu_ms; }
};

/// A key at half and at twice its default, and the figure that it changes most.
struct EffectKnob {
  std::string table, key;
  double value = 0.0, fallback = 0.0;      ///< [unit of the key]
  std::string figure;                      ///< that changes most, relative to the larger of both; empty: none does
  double before = 0.0, after = 0.0;        ///< [unit of the figure]
  double cpu_ms = 0.0, fallback_ms = 0.0;  ///< [ms] as EffectRun::cpu_ms
};

struct EffectsCost {
  std::vector<EffectPrice> prices;
  std::vector<EffectKnob> knobs;
  std::vector<Ladder> ladders;
};

struct EffectsCostOptions : TrialScene {
  int repeats = 5;  ///< of each run of the prices
  bool prices = true;
  bool knobs = true;              ///< keys at half and at twice their default
  bool ladders = true;            ///< errors of the keys that trade time for accuracy
  std::vector<std::string> only;  ///< tables of the effects that are measured; empty: all
  StudyRuns runs;
};

[[nodiscard]] Result<EffectsCost> measure_effects_cost(const EffectsCostOptions& options);
[[nodiscard]] std::vector<CostRow> effects_cost_rows(const EffectsCost& cost);
/// @returns the tables as they are printed and stand in docs.
[[nodiscard]] std::string effects_cost_tables(const EffectsCost& cost);
/// @returns prices and knobs as JSON, schema burrhole.cost_effects/1.
[[nodiscard]] std::string effects_cost_json(const EffectsCost& cost);
/// Writes cost.csv, effects.md, effects.html and the plots effects.svg (prices), effects_accuracy.svg and effects_general.svg (errors against
/// time) into a folder. `unavailable` without gnuplot: the first two are written.
[[nodiscard]] Status write_effects_cost(const EffectsCost& cost, const std::string& folder);

}  // namespace burrhole
