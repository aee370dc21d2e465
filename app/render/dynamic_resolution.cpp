#include "app/render/dynamic_resolution.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

double DynamicResolution::resolution() const noexcept {
  if (!(full_time_ > 0.0)) return coarsest_;
  const double finest = std::sqrt(budget_ / full_time_);
  return std::clamp(kStep * std::floor(finest / kStep), coarsest_, 1.0);
}

void DynamicResolution::record(double resolution, double seconds) noexcept {
  const double full = seconds / (resolution * resolution);
  full_time_ = full > full_time_ ? full : 0.5 * (full_time_ + full);
}

}  // namespace burrhole
