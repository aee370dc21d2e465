/// app/report/tip_speed.h: the speed of the tip from the time series of its depth, for plots.
///   Units  mm, s.   Thread  any.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace burrhole {

/// @returns the speed [mm/s] at each sample, averaged over `span` samples around it: over shorter spans the motion of single ticks dominates.
/// NaN where that span has no length in time, as where a live run evaluated contact several times for one pose of a hand that missed its ticks,
/// or where a sample is not finite. @param time_s does not decrease, the size of depth_mm.
[[nodiscard]] std::vector<double> tip_speed(std::span<const double> time_s, std::span<const double> depth_mm, std::size_t span);

}  // namespace burrhole
