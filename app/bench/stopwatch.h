/// app/bench/stopwatch.h: two ways of doing one thing, timed by turns in one process, so that a busy machine slows both alike.
///   Times are CPU time of all threads: what a neighbour on the machine takes does not count, what a driver's threads take does.
#pragma once

#include <functional>

namespace burrhole {

/// `prepare`, where there is one, runs before each timed run and is not timed.
struct Side {
  std::function<void()> prepare;
  std::function<void()> run;
};

struct StopwatchPlan {
  int pairs_least = 15, pairs_most = 61;  ///< timed runs of each side: as many as the budget allows
  double budget = 3.0;                    ///< [s] for all pairs
  double least_sample = 0.5e-3;           ///< [s] a side without `prepare` is repeated within a sample until it lasts that long
};

/// Seconds of one run.
struct Medians {
  double baseline = 0.0, value = 0.0;
};

/// Each side runs once unmeasured, then baseline and value by turns.
[[nodiscard]] Medians time_by_turns(const StopwatchPlan& plan, const Side& baseline, const Side& value);

}  // namespace burrhole
