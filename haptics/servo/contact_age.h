/// haptics/servo/contact_age.h: the age at which the servo treats a contact result as stale.   Units SI.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace burrhole {

inline constexpr double kLeastContactAge = 0.010;  ///< [s] stalls shorter than this come from system load, not from a lost thread

/// [ticks] Three contact periods, but not less than kLeastContactAge. `period` [s] > 0 is the servo's.
[[nodiscard]] inline std::uint64_t contact_age_limit(int contact_ticks, double period) noexcept {
  return std::max(3 * static_cast<std::uint64_t>(std::max(1, contact_ticks)),
                  static_cast<std::uint64_t>(std::ceil(kLeastContactAge / period * (1.0 - 1e-12))));
}

}  // namespace burrhole
