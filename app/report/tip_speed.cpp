#include "app/report/tip_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/assert.h"

namespace burrhole {

std::vector<double> tip_speed(std::span<const double> time_s, std::span<const double> depth_mm, std::size_t span) {
  BH_ASSERT(time_s.size() == depth_mm.size());
  std::vector<double> out(time_s.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t n = 0; n < time_s.size(); ++n) {
    const std::size_t a = n < span / 2 ? 0 : n - span / 2;
    const std::size_t b = std::min(time_s.size() - 1, n + span / 2);
    const double took = time_s[b] - time_s[a];
    if (!(took > 0.0)) continue;
    const double speed = (depth_mm[b] - depth_mm[a]) / took;
    if (std::isfinite(speed)) out[n] = speed;
  }
  return out;
}

}  // namespace burrhole
