/// core/base/simd.h: selection of the SIMD level of all vector kernels: the best that the machine supports, or a forced one.
///   All levels return the same bits (no fused multiply-add, sums in a fixed order). The level changes speed only.
///   Errors  bad_input for an unknown or unsupported level.
///   Thread  choose the level before other threads start. It is global to the process (Highway keeps it), the only global of this library.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

enum class SimdLevel { sse4, avx2, avx512 };

[[nodiscard]] std::string_view name_of(SimdLevel level) noexcept;
/// @returns the levels that this machine supports, weakest first; empty if kernels run in their portable form.
[[nodiscard]] std::vector<SimdLevel> simd_levels();
/// @returns the level of a name ("sse4", "avx2", "avx512"), or nothing for "auto" (the best level). bad_input if the name is unknown (the
/// message lists the names) or is not in `levels` (the message lists `levels`).
[[nodiscard]] Result<std::optional<SimdLevel>> simd_level_named(std::string_view name, std::span<const SimdLevel> levels);
/// Sets the level of this process by name. Errors as simd_level_named() with the levels of this machine.
[[nodiscard]] Status choose_simd(std::string_view name);
/// @returns the name of the level in use, or "portable".
[[nodiscard]] std::string simd_in_use();

/// Restores, at its destruction, the level that was in use at its construction. For code that runs at several levels.
class SimdLevelGuard {
 public:
  SimdLevelGuard() noexcept;
  ~SimdLevelGuard();
  SimdLevelGuard(const SimdLevelGuard&) = delete;
  SimdLevelGuard& operator=(const SimdLevelGuard&) = delete;

 private:
  std::int64_t best_;  // Highway's bit of the best target in use
};

}  // namespace burrhole
