/// app/bench/stopwatch.h: times two implementations in paired runs of one process, so that the load of the machine affects both equally.
///   Times are CPU times of all threads of the process, those of drivers included; other processes do not count.   Units  s.   Thread  one.
#pragma once

#include <functional>
#include <vector>

namespace burrhole {

/// One of two implementations.
struct Side {
  std::function<void()> prepare;  ///< runs before each timed run and is not timed; may be empty
  std::function<void()> run;
};

struct StopwatchPlan {
  int pairs_least = 15, pairs_most = 61;  ///< [-] number of timed pairs: as many as the budget allows
  double budget = 3.0;                    ///< [s] for all pairs
  double least_sample = 0.5e-3;           ///< [s] a side without `prepare` is repeated within a sample until it takes that long
};

struct Medians {
  double baseline = 0.0, value = 0.0;  ///< [s] of one run
};

/// @returns the CPU time of all threads of the process so far [s].
[[nodiscard]] double cpu_seconds();
/// @returns the upper median. @pre not empty.
[[nodiscard]] double median(std::vector<double> samples);

/// Runs each side once without timing, then baseline and value in alternation. @returns the medians.
[[nodiscard]] Medians time_paired(const StopwatchPlan& plan, const Side& baseline, const Side& value);

}  // namespace burrhole
