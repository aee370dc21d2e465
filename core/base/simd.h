/// core/base/simd.h: the SIMD level that every vector kernel runs at: the best the machine has, or one that is forced.
///   All levels give the same bits (no fused multiply-add, sums in a fixed order), so a level is a question of speed alone.
///   Thread  choose before other threads start: the choice is the process's (Highway keeps it), the one global of this library.
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
/// What this machine can run, weakest first; empty where kernels run their portable form.
[[nodiscard]] std::vector<SimdLevel> simd_levels();
/// What a name asks of a machine that has `levels`: "sse4", "avx2", "avx512", or nothing for "auto" (the best). bad_input names what may be
/// written, or, where the machine lacks what is asked for, what it has.
[[nodiscard]] Result<std::optional<SimdLevel>> simd_level_named(std::string_view name, std::span<const SimdLevel> levels);
/// The same for this machine, and puts it in use.
[[nodiscard]] Status choose_simd(std::string_view name);
/// The level in use: a name as above, or "portable".
[[nodiscard]] std::string simd_in_use();

/// Puts the level that was in use when it was made back in use at its end: round code that runs at several.
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
