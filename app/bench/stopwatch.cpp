#include "app/bench/stopwatch.h"

#include <time.h>

#include <algorithm>

namespace burrhole {
namespace {

/// @returns the time of one run [s], the mean of `repeats` successive runs.
double sample(const Side& side, int repeats) {
  if (side.prepare) side.prepare();
  const double start = cpu_seconds();
  for (int n = 0; n < repeats; ++n) side.run();
  return (cpu_seconds() - start) / repeats;
}

int repeats_for(const StopwatchPlan& plan, const Side& side) {
  const double once = sample(side, 1);
  if (side.prepare || once >= plan.least_sample) return 1;
  return static_cast<int>(std::min(1e4, plan.least_sample / std::max(once, 1e-8))) + 1;
}

}  // namespace

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return *middle;
}

Medians time_paired(const StopwatchPlan& plan, const Side& baseline, const Side& value) {
  const int baseline_repeats = repeats_for(plan, baseline), value_repeats = repeats_for(plan, value);
  std::vector<double> baseline_samples, value_samples;
  const double start = cpu_seconds();
  for (int n = 0; n < plan.pairs_most; ++n) {
    if (n >= plan.pairs_least && cpu_seconds() - start > plan.budget) break;
    baseline_samples.push_back(sample(baseline, baseline_repeats));
    value_samples.push_back(sample(value, value_repeats));
  }
  return {median(std::move(baseline_samples)), median(std::move(value_samples))};
}

}  // namespace burrhole
