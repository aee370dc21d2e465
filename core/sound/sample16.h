/// core/sound/sample16.h: a sample as 16 bits.   Units  -1..1 becomes -32767..32767.   Errors  none.   Thread  any.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace burrhole {

/// @returns round(32767 s), half away from zero, of a sample that is clamped to -1..1.
[[nodiscard]] inline std::int16_t sample16(float sample) noexcept {
  return static_cast<std::int16_t>(std::lround(32767.0f * std::clamp(sample, -1.0f, 1.0f)));
}

}  // namespace burrhole
