#include "core/drill/engaged_kernels.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/simd.h"

using namespace burrhole;

TEST_CASE("engaged voxels: what is left by vectors is what the portable exponential leaves, to nothing at all") {
  constexpr std::size_t kCount = 501;
  std::array<float, kCount + 8> available{}, exposure{}, hardness{}, left{};
  hardness.fill(1.0f);
  for (std::size_t n = 0; n < kCount; ++n) {
    available[n] = static_cast<float>(uniform01(3, n));
    exposure[n] = static_cast<float>(std::pow(10.0, 6.0 * uniform11(4, n)));
    hardness[n] = 0.1f + static_cast<float>(uniform01(5, n));
  }
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const std::string& level : levels) {
    CAPTURE(level);
    REQUIRE(choose_simd(level).ok());
    int none = 0, whole = 0;
    for (const double turns : {0.37, 12.0, std::numeric_limits<double>::infinity()}) {
      decay({kCount, turns, available.data(), exposure.data(), hardness.data(), left.data()});
      for (std::size_t n = 0; n < kCount; ++n) {
        const double power = -turns * static_cast<double>(exposure[n]) / static_cast<double>(hardness[n]);
        REQUIRE(left[n] == static_cast<float>(static_cast<double>(available[n]) * portable_exp(power)));
        none += left[n] == 0.0f ? 1 : 0;
        whole += left[n] > 0.9f * available[n] ? 1 : 0;
      }
    }
    CHECK(none > 100);
    CHECK(whole > 100);
  }
  REQUIRE(choose_simd("auto").ok());
}
