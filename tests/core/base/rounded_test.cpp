#include "core/base/rounded.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"

using namespace burrhole;

TEST_CASE("rounded: equals lround at halves, beside them, and at numbers up to 2^24") {
  for (int n = 0; n < 70000; ++n) {
    const float half = static_cast<float>(n) + 0.5f;
    for (const float value : {static_cast<float>(n), half, std::nextafter(half, 0.0f), std::nextafter(half, 1e9f)})
      REQUIRE(rounded(value) == std::lround(value));
  }
  CHECK(rounded(std::nextafter(0.5f, 0.0f)) == 0);  // where half a unit is added first, the sum is rounded up to 1
  for (std::uint64_t n = 0; n < 100000; ++n) {
    const auto value = static_cast<float>(uniform01(1, n) * 16777216.0);
    REQUIRE(rounded(value) == std::lround(value));
  }
}
