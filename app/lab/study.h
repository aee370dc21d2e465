/// app/lab/study.h: runs the trials of a study one after the other: keeps each result, takes those of an earlier call that was interrupted,
///   and estimates the duration of the rest from the first trial that it measures.
///   Units  as the study's.   Errors  those of a trial; bad_input if results cannot be kept.   Thread  one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/lab/partial_results.h"

namespace burrhole {

struct StudyRuns {
  std::string partial{};                                       ///< file of results that are kept while trials run; empty: none
  std::function<void(double, const std::string&)> progress{};  ///< share done 0..1 and the last trial; may be empty
  std::function<void(const std::string&)> say{};               ///< receives one line, the estimate; may be empty
  std::function<double()> now{};                               ///< [s] clock of the estimate; empty: the steady clock
};

/// One trial: what its result depends on, how progress names it, and how many figures it has.
struct StudyTrial {
  TrialKey key;
  std::string name;
  std::size_t figures = 0;
};

class Study {
 public:
  using Figures = std::vector<double>;

  /// @param trials number of trials that run() will be called for.
  Study(StudyRuns runs, std::size_t trials);
  /// @returns the figures of the trial: those of an earlier call, or those that `measure` returns, which are kept. Says the estimate after
  /// the first trial that is measured.
  [[nodiscard]] Result<Figures> run(const StudyTrial& trial, const std::function<Result<Figures>()>& measure);
  [[nodiscard]] std::size_t done() const noexcept { return measured_ + earlier_; }

 private:
  [[nodiscard]] double now() const;
  void estimate();
  StudyRuns runs_;
  PartialResults results_;
  std::size_t trials_, measured_ = 0, earlier_ = 0;
  double spent_ = 0.0;  // [s] in `measured_` trials
};

/// @returns "under a minute", "about 3 min" or "about 1 h 20 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace burrhole
