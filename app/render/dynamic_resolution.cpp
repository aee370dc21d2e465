#include "app/render/pace.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

double Pace::resolution() const noexcept {
  if (!(full_ > 0.0)) return kCoarsest;
  const double finest = std::sqrt(budget_ / full_);
  return std::clamp(kStep * std::floor(finest / kStep), kCoarsest, 1.0);
}

void Pace::record(double resolution, double seconds) noexcept {
  const double full = seconds / (resolution * resolution);
  full_ = full > full_ ? full : 0.5 * (full_ + full);
}

}  // namespace burrhole
