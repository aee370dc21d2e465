#include "app/window/window_figures.h"

#include <algorithm>

namespace burrhole {

void PictureTimes::add(double seconds) {
  if (seconds_.size() < kMost)
    seconds_.push_back(static_cast<float>(seconds));
  else
    seconds_[next_++ % kMost] = static_cast<float>(seconds);
}

double PictureTimes::at(double share) const {
  if (seconds_.empty()) return 0.0;
  std::vector<float> sorted = seconds_;
  std::ranges::sort(sorted);
  return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
}

}  // namespace burrhole
