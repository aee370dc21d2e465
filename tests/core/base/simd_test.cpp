#include "core/base/simd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <string>

using namespace burrhole;

namespace {

struct BackToAuto {
  ~BackToAuto() { (void)choose_simd("auto"); }
};

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
  const BackToAuto guard;
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
