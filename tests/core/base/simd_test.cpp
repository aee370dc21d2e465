#include "core/base/simd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <string>

using namespace burrhole;

namespace {

/// The processor's own word, by the kernel: shares nothing with the library asked.
bool machine_says(const std::string& flag) {
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line))
    if (line.starts_with("flags")) return (line + " ").find(" " + flag + " ") != std::string::npos;
  return false;
}

}  // namespace

TEST_CASE("simd: levels are those of the processor") {
  const auto levels = simd_levels();
  const auto has = [&](SimdLevel level) { return std::ranges::find(levels, level) != levels.end(); };
  CHECK(has(SimdLevel::sse4) == machine_says("sse4_2"));
  CHECK(has(SimdLevel::avx2) == (machine_says("avx2") && machine_says("fma")));
  CHECK(has(SimdLevel::avx512) == (machine_says("avx512f") && machine_says("avx512dq") && machine_says("avx512vl")));
}

TEST_CASE("simd: a forced level is the one in use and auto is the best") {
  const SimdLevelGuard guard;
  const auto levels = simd_levels();
  for (const SimdLevel level : levels) {
    REQUIRE(choose_simd(name_of(level)).ok());
    CHECK(simd_in_use() == name_of(level));
    CHECK(simd_levels() == levels);  // asking does not change, forcing does not hide
    CHECK(simd_in_use() == name_of(level));
  }
  REQUIRE(choose_simd("auto").ok());
  CHECK(simd_in_use() == (levels.empty() ? "portable" : std::string(name_of(levels.back()))));
}

TEST_CASE("simd: a name that is none is refused with the names there are") {
  const Status refused = choose_simd("avx1024");
  REQUIRE(!refused.ok());
  CHECK(refused.error().code == ErrorCode::bad_input);
  CHECK(refused.error().message == "SIMD level \"avx1024\" must be one of: auto, sse4, avx2, avx512");
}

TEST_CASE("simd: a level that the machine lacks is refused with those it has") {
  const std::vector<SimdLevel> older{SimdLevel::sse4, SimdLevel::avx2};
  const auto refusal = [](std::string_view name, const std::vector<SimdLevel>& levels) {
    const auto level = simd_level_named(name, levels);
    REQUIRE(!level.ok());
    CHECK(level.error().code == ErrorCode::bad_input);
    return level.error().message;
  };
  CHECK(refusal("avx512", older) == "this machine has no avx512; it has: sse4, avx2");
  CHECK(refusal("avx2", {SimdLevel::sse4}) == "this machine has no avx2; it has: sse4");
  CHECK(refusal("sse4", {}) == "this machine has no sse4; it has: none");
  CHECK(refusal("AVX2", older) == "SIMD level \"AVX2\" must be one of: auto, sse4, avx2, avx512");
  const auto level = simd_level_named("avx2", older), best = simd_level_named("auto", {});
  REQUIRE(level.ok());
  REQUIRE(best.ok());
  CHECK(*level == SimdLevel::avx2);
  CHECK_FALSE(best->has_value());
}

TEST_CASE("simd: a guard puts back what was in use, forced or not") {
  const SimdLevelGuard outer;
  const auto levels = simd_levels();
  std::vector<std::string> names{"auto"};
  for (const SimdLevel level : levels) names.emplace_back(name_of(level));
  for (const std::string& before : names)
    for (const std::string& inside : names) {
      REQUIRE(choose_simd(before).ok());
      const std::string in_use = simd_in_use();
      {
        const SimdLevelGuard guard;
        REQUIRE(choose_simd(inside).ok());
      }
      CHECK(simd_in_use() == in_use);
    }
}
