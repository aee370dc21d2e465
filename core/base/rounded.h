/// core/base/rounded.h: rounding of numbers that are not negative, without the call into the library that std::lround costs.
#pragma once

namespace burrhole {

/// @returns the nearest whole number, the larger of two, as std::lround does. @param value from 0 to 2^24.
[[nodiscard]] constexpr int rounded(float value) noexcept {
  const int below = static_cast<int>(value);
  return below + static_cast<int>(value - static_cast<float>(below) >= 0.5f);
}

}  // namespace burrhole
