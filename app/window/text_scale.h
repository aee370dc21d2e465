/// app/window/text_scale.h: the size of texts that a person sets, as a factor of the desktop's own.
///   Units  [-].   Errors  none.   Thread  any.
#pragma once

#include <algorithm>
#include <cmath>

namespace burrhole {

inline constexpr double kSmallestText = 0.5, kLargestText = 4.0;

/// @returns the size one step larger or smaller, in the range. A step back ends where it began.
[[nodiscard]] inline double next_text_scale(double scale, bool larger) noexcept {
  constexpr double kStep = 1.125;
  const double steps = std::round(std::log(scale) / std::log(kStep)) + (larger ? 1.0 : -1.0);
  return std::clamp(std::pow(kStep, steps), kSmallestText, kLargestText);
}

}  // namespace burrhole
