/// core/base/hash.h: 64-bit hash of a sequence of values (FNV-1a over 64-bit words, finished by mix64). The order of values matters.
///   The hash is the same on every machine. It is not cryptographic.   Frame  none: vectors are hashed as three numbers.   Thread  one
///   owner.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/base/geometry.h"
#include "core/base/random.h"

namespace burrhole {

/// @returns 16 hexadecimal digits.
[[nodiscard]] inline std::string hash_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

class Hash64 {
 public:
  void add(std::uint64_t word) noexcept {
    state_ ^= word;
    state_ *= 0x100000001b3ull;
    state_ ^= state_ >> 29;
  }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) noexcept { add(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(value))); }
  void add(const Vec3& v) noexcept {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return mix64(state_); }
  [[nodiscard]] std::string hex() const { return hash_text(value()); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ull;
};

}  // namespace burrhole
