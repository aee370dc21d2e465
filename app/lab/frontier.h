/// app/lab/frontier.h: the measured stability frontier beside the lines of theory: which stiffness the whole shipped loop shows before it
///   gets unstable, by device, hand, damping, contact rate and scheme.
///   Units SI in the rows, units in the names of the CSV.   Thread rows are measured on workers of their own, results in fixed order: the
///   same bits on any number of them.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/lab/frontier_loop.h"
#include "app/lab/frontier_oracle.h"

namespace burrhole {

/// A figure that was published or derived elsewhere, to be met through the whole loop.
struct KnownLimit {
  std::string_view name;
  double mass = 0.1, damping = 5.0, spring = 0.0;  ///< of device and hand
  int servo_hz = 1000, delay = 0, contact_ticks = 1, latency_ticks = 0;
  MultiRateScheme scheme = MultiRateScheme::hold;
  double coupling_damping = 0.0;
  double stiffness = 0.0;  ///< [N/m] the figure
};
/// The project's facts, section 2 and 3. N = 33 does not divide 1 kHz and is left out.
[[nodiscard]] std::span<const KnownLimit> known_limits() noexcept;
/// Loop and exact system of a known limit: no friction, steps or caps, speeds by plain differences.
[[nodiscard]] FrontierLoopConfig loop_of(const KnownLimit& known);
[[nodiscard]] SampledWall wall_of(const FrontierLoopConfig& config);

/// NaN where a figure does not apply.
struct FrontierRow {
  std::string part;  ///< "known", "damping", "rate" or "let go"
  std::string device, hand, bone, start, scheme;
  double mass = 0.0, damping = 0.0, spring = 0.0;
  int servo_hz = 1000, delay = 0, contact_ticks = 1, latency_ticks = 0;
  double coupling_damping = 0.0;
  double measured = std::numeric_limits<double>::quiet_NaN();  ///< [N/m]
  double exact = std::numeric_limits<double>::quiet_NaN();     ///< of the sampled system
  double known = std::numeric_limits<double>::quiet_NaN();     ///< the figure from elsewhere
  double passive = std::numeric_limits<double>::quiet_NaN(), quantised = std::numeric_limits<double>::quiet_NaN(),
         linear = std::numeric_limits<double>::quiet_NaN();
};

struct FrontierOptions {
  bool thin = false;                     ///< one device and a few points: for tests
  std::string part{};                    ///< of `FrontierRow::part`: these rows alone; empty: all
  unsigned workers = 0;                  ///< 0: one a core
  std::function<void(double)> progress;  ///< share done 0..1, from any worker, one at a time; may be empty
};

/// All rows, in fixed order. The first fault of a run passes through.
[[nodiscard]] Result<std::vector<FrontierRow>> measure_frontier(const FrontierOptions& options);

/// frontier.csv, frontier_rates.svg, frontier_DEVICE.svg and frontier.html into a folder. `unavailable` without gnuplot: the CSV is then
/// there.
[[nodiscard]] Status write_frontier(const std::vector<FrontierRow>& rows, const std::string& folder);

}  // namespace burrhole
