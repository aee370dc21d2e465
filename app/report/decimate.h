/// app/report/decimate.h: reduces long series to the resolution of a plot without losing peaks.
///   Units  any.   Errors  none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace burrhole {

/// Divides [x.front(), x.back()] into `buckets` equal columns and keeps from each the first, last, lowest and highest sample, and the first
/// sample that is not finite (a gap stays a gap). @pre x does not decrease; x.size() == y.size().
/// @returns increasing indices, at most 5 per bucket; all indices if there are no more samples than that.
[[nodiscard]] std::vector<std::size_t> decimate(std::span<const double> x, std::span<const double> y, std::size_t buckets);

}  // namespace burrhole
