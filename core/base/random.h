/// core/base/random.h: counter-based random numbers: a value depends on (seed, counter) alone, so order and threads do not matter.
#pragma once

#include <cstdint>

namespace burrhole {

/// Mixes 64 bits; constants of Vigna's splitmix64 (public domain reference generator).
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1) with 53 bits.
[[nodiscard]] constexpr double uniform01(std::uint64_t seed, std::uint64_t counter) noexcept {
  return static_cast<double>(mix64(mix64(seed) ^ counter) >> 11) * 0x1.0p-53;
}

/// Uniform in [-1, 1).
[[nodiscard]] constexpr double uniform11(std::uint64_t seed, std::uint64_t counter) noexcept {
  return 2.0 * uniform01(seed, counter) - 1.0;
}

}  // namespace burrhole
