/// app/stage/accuracy.h: what an effect states about its accuracy: the keys by which a scene trades time for error, and the figures of a run that
///   approach a limit as these keys get finer. `burrhole cost effects` measures the error and the price of each.
///   Units  those of the keys and figures.   Errors  none: a name that is no key or no figure fails a test.   Thread  any.
#pragma once

#include <string>
#include <vector>

namespace burrhole {

/// A figure that a finer knob should change less and less.
struct AccuracyFigure {
  std::string name;    ///< of the effect's report(), or of the run (run_figures() of app/lab/effects_trial.h)
  double scale = 0.0;  ///< [unit of the figure] errors are relative to the reference, or to this if the reference is smaller
  double zero = 0.0;   ///< [unit of the figure] from which the reference counts: 37 of a temperature of bone
};

/// A key whose value is changed together with a knob.
struct AccuracyCompanion {
  std::string key;     ///< "table.key", or a key of the top of the file
  double power = 1.0;  ///< [-] its value is its default times (multiple of the knob)^power
};

/// A number of the effect's table that trades time for error.
struct AccuracyKnob {
  std::string key;                ///< of the effect's table
  std::vector<double> multiples;  ///< [-] of the default, coarse to fine; 1 is one of them
  double reference = 1.0;         ///< [-] multiple of the reference run, finer than all of them
  bool of_all = false;            ///< it acts on all effects, so the figures of each are measured
  std::vector<AccuracyCompanion> along{};
};

struct EffectAccuracy {
  std::vector<AccuracyFigure> figures{};
  std::vector<AccuracyKnob> knobs{};
  std::string table{};  ///< lines of the effect's table with which a scene without it is measured; empty: none that need be given
};

}  // namespace burrhole
