/// tests/support/stability_search.h: the largest stiffness at which a sampled loop is stable, found by running it.
/// Near the limit growth is slow (at 1.01 of it a factor 10 takes 5e3 to 9e4 ticks), so the sign of the envelope's growth decides.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace burrhole::test {

/// Log growth of an oscillation's envelope over `ticks`, of its last sixth against its second.
/// @param step advances the loop by one tick and returns the deviation from rest (any sign and unit), the first time of the push's size.
/// Beyond doubt the run ends early: 1 when it has grown a million times, -1 when it is gone. A limit on force in the loop must lie
/// beyond that million, or growth ends there unseen.
template <class Step>
[[nodiscard]] double log_growth(Step&& step, int ticks) {
  const int window = ticks / 6;
  double first = 0.0, early = 0.0, late = 0.0, recent = 0.0;
  for (int n = 0; n < ticks; ++n) {
    const double size = std::abs(step());
    if (n == 0) first = std::max(size, 1e-300);
    if (!(size < 1e6 * first)) return 1.0;  // not finite is unstable too
    if (n >= window && n < 2 * window) early = std::max(early, size);
    if (n >= ticks - window) late = std::max(late, size);
    recent = std::max(recent, size);
    if (n % 1000 == 999) {
      if (recent < 1e-9 * first) return -1.0;
      recent = 0.0;
    }
  }
  return early > 0.0 && late > 0.0 ? std::log(late / early) : -1.0;
}

/// Bisects between a stiffness that is stable and one that is not [N/m], until they are within `ratio` of each other.
/// @param growth_at log growth of the loop at that stiffness.
template <class Growth>
[[nodiscard]] double largest_stiffness(Growth&& growth_at, double stable = 10.0, double unstable = 1e6, double ratio = 1.002) {
  while (unstable / stable > ratio) {
    const double middle = std::sqrt(stable * unstable);
    (growth_at(middle) > 0.0 ? unstable : stable) = middle;
  }
  return std::sqrt(stable * unstable);
}

}  // namespace burrhole::test
