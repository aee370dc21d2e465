#include "app/view/picture_memory.h"

namespace burrhole {

std::uint64_t picture_bytes(const DisplayConfig& display) noexcept {
  constexpr std::uint64_t kRayBytes = 31, kSliceRayBytes = 42;
  const auto rays = static_cast<std::uint64_t>(display.quality.supersample);
  const std::uint64_t samples = rays * rays * static_cast<std::uint64_t>(display.width) * static_cast<std::uint64_t>(display.height);
  return samples * (display.method == "slices" ? kSliceRayBytes : kRayBytes);
}

}  // namespace burrhole
