/// app/report/decimate.h: long series to what a picture can show, without losing a peak.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace burrhole {

/// Cuts [x.front(), x.back()] into `buckets` equal columns and keeps, of each, the first, the last, the lowest and the highest sample, and
/// the first one that is not finite (a gap stays a gap). x does not fall; x.size() == y.size().
/// @returns indices that rise, at most 5 a bucket; all of them when there are no more samples than that.
[[nodiscard]] std::vector<std::size_t> decimate(std::span<const double> x, std::span<const double> y, std::size_t buckets);

}  // namespace burrhole
