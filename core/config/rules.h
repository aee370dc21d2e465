/// core/config/rules.h: rules of numbers that many tables share. Bounds are as written in the file; `to_si` converts.
#pragma once

#include "core/config/toml.h"

namespace burrhole {

/// At least 0. @param fallback as written in the file.
[[nodiscard]] inline NumberRule at_least_zero(double fallback, double to_si = 1.0, double max = 1e9) {
  return {.fallback = fallback, .min = 0.0, .max = max, .to_si = to_si};
}
/// Above 0. @param fallback as written in the file.
[[nodiscard]] inline NumberRule above_zero(double fallback, double to_si = 1.0, double max = 1e9) {
  return {.fallback = fallback, .min = 0.0, .max = max, .min_open = true, .to_si = to_si};
}
/// From min to max, both allowed.
[[nodiscard]] inline NumberRule within(double fallback, double min, double max) { return {.fallback = fallback, .min = min, .max = max}; }

}  // namespace burrhole
