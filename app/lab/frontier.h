/// app/lab/frontier.h: the measured stability frontier and the theoretical limits: the largest stiffness at which the whole shipped loop is
///   stable, by device, hand, damping, contact rate and scheme.
///   Units SI in the rows, units in the column names of the CSV.   Errors  those of a run; unavailable without gnuplot.
///   Thread rows are measured on worker threads; results are in fixed order, the same bits for any number of workers.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/lab/frontier_loop.h"
#include "app/lab/oracle/frontier_oracle.h"

namespace burrhole {

/// A stiffness limit computed apart from the loop that is measured, to be met through the whole loop.
struct KnownLimit {
  std::string_view name;
  double mass = 0.1, damping = 5.0, spring = 0.0;                        ///< [kg], [N s/m], [N/m] of device and hand
  int servo_hz = 1000, delay = 0, contact_ticks = 1, latency_ticks = 0;  ///< servo_hz [Hz], the others [ticks]
  MultiRateScheme scheme = MultiRateScheme::hold;
  double coupling_damping = 0.0;  ///< [N s/m]
  double stiffness = 0.0;         ///< [N/m] the limit, rounded to a whole number
};
/// 52 linear systems on one flat wall, their limits written by scripts/frontier_known. Contact every 33 ticks is left out: 33 does not
/// divide 1000.
[[nodiscard]] std::span<const KnownLimit> known_limits() noexcept;
/// Loop and exact sampled system of a known limit: no friction, quantisation or force limit; velocity by plain differences.
[[nodiscard]] FrontierLoopConfig loop_of(const KnownLimit& known);
[[nodiscard]] SampledWall wall_of(const FrontierLoopConfig& config);

/// NaN in values that do not apply.
struct FrontierRow {
  std::string part;  ///< "known", "damping", "rate" or "released"
  std::string device, hand, bone, start, scheme;
  double mass = 0.0, damping = 0.0, spring = 0.0;                        ///< [kg], [N s/m], [N/m] of device and hand
  int servo_hz = 1000, delay = 0, contact_ticks = 1, latency_ticks = 0;  ///< servo_hz [Hz], the others [ticks]
  double coupling_damping = 0.0;                                         ///< [N s/m]
  double measured = std::numeric_limits<double>::quiet_NaN();            ///< [N/m]
  double exact = std::numeric_limits<double>::quiet_NaN();               ///< [N/m] of the sampled system
  double known = std::numeric_limits<double>::quiet_NaN();               ///< [N/m] the published limit
  double passive = std::numeric_limits<double>::quiet_NaN(), quantised = std::numeric_limits<double>::quiet_NaN(),
         // [N/m] passive limit, quantised passive limit, linear limit with delay; see oracle/frontier_oracle.h.
      linear = std::numeric_limits<double>::quiet_NaN();
};

struct FrontierOptions {
  bool thin = false;                     ///< one device and a few points only: for tests
  std::string part{};                    ///< `FrontierRow::part` of the rows to measure; empty: all
  unsigned workers = 0;                  ///< 0: one per core
  std::function<void(double)> progress;  ///< share done 0..1, called from any worker, one at a time; may be empty
};

/// @returns all rows in fixed order, or the first error of a run.
[[nodiscard]] Result<std::vector<FrontierRow>> measure_frontier(const FrontierOptions& options);

/// Writes frontier.csv, frontier_rates.svg, frontier_DEVICE.svg and frontier.html into a folder. `unavailable` without gnuplot: the CSV is
/// written.
[[nodiscard]] Status write_frontier(const std::vector<FrontierRow>& rows, const std::string& folder);

}  // namespace burrhole
