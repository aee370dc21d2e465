#include "app/report/decimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr std::size_t kKeptPerBucket = 5;

/// Appends the kept samples of bucket [begin, end), in order, each index once.
void keep_extremes(std::span<const double> y, std::size_t begin, std::size_t end, std::vector<std::size_t>& kept) {
  std::size_t picks[kKeptPerBucket] = {begin, begin, begin, begin, end - 1};
  std::size_t& low = picks[1];
  std::size_t& high = picks[2];
  std::size_t& gap = picks[3];
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(y[i])) {
      if (std::isfinite(y[gap])) gap = i;
      continue;
    }
    // A comparison with NaN is false, so `not less` lets the first finite sample replace a NaN.
    if (!(y[low] <= y[i])) low = i;
    if (!(y[high] >= y[i])) high = i;
  }
  std::sort(std::begin(picks), std::end(picks));
  kept.insert(kept.end(), std::begin(picks), std::unique(std::begin(picks), std::end(picks)));
}

}  // namespace

std::vector<std::size_t> decimate(std::span<const double> x, std::span<const double> y, std::size_t buckets) {
  BH_ASSERT(x.size() == y.size() && buckets > 0);
  std::vector<std::size_t> kept;
  if (x.size() <= kKeptPerBucket * buckets) {
    kept.resize(x.size());
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  const double width = (x.back() - x.front()) / static_cast<double>(buckets);
  for (std::size_t bucket = 0, begin = 0; bucket < buckets; ++bucket) {
    const double edge = x.front() + width * static_cast<double>(bucket + 1);
    std::size_t end = x.size();
    if (bucket + 1 < buckets) end = static_cast<std::size_t>(std::upper_bound(x.begin() + begin, x.end(), edge) - x.begin());
    if (end > begin) keep_extremes(y, begin, end, kept);
    begin = end;
  }
  return kept;
}

}  // namespace burrhole
