/// core/base/color_ramp.h: the colours of values in maps and pictures: from dark violet over red to yellow, each lighter than the one before, so
/// that they can be read without colour.
///   Units  shares of the scale [-]; sRGB values as stored.   Errors  none.   Thread  any.   Source  own choice of stops.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace burrhole {

struct RampColor {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const RampColor &, const RampColor &) = default;
};
struct RampStop {
  double share = 0.0;  ///< [-] of the scale
  RampColor color;
};

/// Between two stops each channel is linear.
inline constexpr std::array<RampStop, 6> kValueRamp{{{0.0, {0x2c, 0x11, 0x5f}},
                                                     {0.25, {0x72, 0x1f, 0x81}},
                                                     {0.5, {0xb7, 0x37, 0x79}},
                                                     {0.75, {0xf1, 0x60, 0x5d}},
                                                     {0.9, {0xfe, 0xb0, 0x78}},
                                                     {1.0, {0xfc, 0xfd, 0xbf}}}};

/// @param share of the scale; outside 0..1 that of the end. @pre not NaN.
[[nodiscard]] inline RampColor ramp_color(double share) noexcept {
  const double at = std::clamp(share, 0.0, 1.0);
  std::size_t n = 1;
  while (n + 1 < kValueRamp.size() && kValueRamp[n].share < at) ++n;
  const RampStop &below = kValueRamp[n - 1], &above = kValueRamp[n];
  const double part = (at - below.share) / (above.share - below.share);
  const auto mixed = [part](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + part * (to - from)));
  };
  return {mixed(below.color.r, above.color.r), mixed(below.color.g, above.color.g), mixed(below.color.b, above.color.b)};
}

}  // namespace burrhole
