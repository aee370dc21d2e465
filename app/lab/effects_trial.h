/// app/lab/effects_trial.h: one run of a scene to which an effect is added, from which one is taken, or of which keys are changed, in lockstep
///   and without pictures.
///   Units  in the names.   Errors  those of the scene.   Thread  one.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/job/summary.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "core/config/key_log.h"

namespace burrhole {

/// What a run gives, by name with its unit. NaN where one does not apply.
using RunFigures = std::vector<std::pair<std::string, double>>;

struct TrialScene {
  std::string scene_file;
  SceneContext context;
  double duration_s = 0.0;  ///< [s] of a run; 0: the scene's
};

/// A scene with an effect added or taken away, or with keys changed.
struct EffectTrial {
  std::string table;
  std::vector<std::string> sets{};    ///< as TomlDocument::set() takes them
  std::vector<std::string> unsets{};  ///< the table, before it those that require it
};

/// A simulation that is ready to run.
struct ReadyTrial {
  std::unique_ptr<LoadedScene> loaded;  ///< at a place of its own: the simulation refers to it
  std::unique_ptr<Simulation> simulation;
};

struct TrialRun {
  double cpu_s = 0.0, wall_s = 0.0;  ///< [s] CPU time of this thread; wall time
  RunSummary summary;
  /// @returns the time [ms] that the steps of an effect took for a simulated second. Timers measure wall time; of a thread that had no processor
  /// for a share of the run this share is taken off.
  [[nodiscard]] double step_ms(std::string_view table) const;
};

/// @returns whether an effect is among those that are measured. @param only empty: all are.
[[nodiscard]] bool is_named(const std::vector<std::string>& only, std::string_view table);
[[nodiscard]] Result<TomlDocument> document_of(const TrialScene& scene, const EffectTrial& trial);
[[nodiscard]] Result<ReadyTrial> prepare(const TrialScene& scene, const EffectTrial& trial);
[[nodiscard]] RunSummary summary_of(const TrialScene& scene, ReadyTrial& ready, double wall_s);
[[nodiscard]] Result<TrialRun> drill(const TrialScene& scene, const EffectTrial& trial);

/// @returns the figures that every run has.
[[nodiscard]] RunFigures run_figures(const RunSummary& summary);
/// @returns the figures that an effect reports, as numbers; none if the run does not have it.
[[nodiscard]] RunFigures effect_figures(const RunSummary& summary, std::string_view table);
/// @returns the hash of bone and forces, in four numbers that a double holds.
[[nodiscard]] std::vector<double> bits_of(const RunSummary& summary);

/// @returns the assignments that give a scene this table, by lines as a scene has them.
[[nodiscard]] std::vector<std::string> sets_of(const std::string& table, const std::string& lines);

struct AddedTable {
  EffectTrial trial;
  std::string given;    ///< the table in one line
  std::string refused;  ///< why the scene cannot be drilled with it; empty: it can
};
/// Finds the smallest table with which a scene can be drilled: the empty one, then the samples of the effect. @param lines not empty: that table
/// alone.
[[nodiscard]] AddedTable added_table(const TrialScene& scene, const EffectEntry& effect, const std::string& lines = {});

/// Every key that the readers of a scene request, with its default.
[[nodiscard]] Result<KeyLog> keys_of(const TrialScene& scene, const EffectTrial& trial);
/// @returns the default of a key as a number; nothing if it has none.
[[nodiscard]] std::optional<double> default_of(const KeyInfo& key);

}  // namespace burrhole
