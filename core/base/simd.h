/// core/base/simd.h: the SIMD level that every vector kernel runs at: the best the machine has, or one that is forced.
///   All levels give the same bits (no fused multiply-add, sums in a fixed order), so a level is a question of speed alone.
///   Thread  choose before other threads start: the choice is the process's (Highway keeps it), the one global of this library.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

enum class SimdLevel { sse4, avx2, avx512 };

[[nodiscard]] std::string_view name_of(SimdLevel level) noexcept;
/// What this machine can run, weakest first; empty where kernels run their portable form.
[[nodiscard]] std::vector<SimdLevel> simd_levels();
/// "sse4", "avx2", "avx512" or "auto" (the best). bad_input names the levels there are when it lacks the one asked for.
[[nodiscard]] Status choose_simd(std::string_view name);
/// The level in use: a name as above, or "portable".
[[nodiscard]] std::string simd_in_use();

}  // namespace burrhole
