#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>

#include "core/base/hash.h"
#include "core/base/random.h"

using namespace burrhole;

namespace {

std::uint64_t hash_of(std::initializer_list<std::uint64_t> words) {
  Hash64 hash;
  for (const std::uint64_t word : words) hash.add(word);
  return hash.value();
}

}  // namespace

TEST_CASE("mix64: the published outputs of splitmix64 for seeds 0 and 1234567") {
  CHECK(mix64(0) == 0xe220a8397b1dcdafull);
  CHECK(mix64(1234567) == 6457827717110365317ull);
  CHECK(mix64(1234567 + 0x9e3779b97f4a7c15ull) == 3203168211198807973ull);
}

TEST_CASE("uniform01: at least 0 and below 1, with the mean, variance and even bins of a uniform variable") {
  constexpr int kCount = 200000, kBins = 64;
  std::array<int, kBins> bins{};
  double sum = 0.0, squares = 0.0;
  for (int n = 0; n < kCount; ++n) {
    const double u = uniform01(42, static_cast<std::uint64_t>(n));
    REQUIRE(u >= 0.0);
    REQUIRE(u < 1.0);
    ++bins[static_cast<std::size_t>(u * kBins)];
    sum += u - 0.5;
    squares += (u - 0.5) * (u - 0.5);
  }
  // Five standard deviations of each estimate: sqrt(1/12/N) of the mean, sqrt(1/180/N) of the variance.
  CHECK(std::abs(sum / kCount) < 5.0 * std::sqrt(1.0 / 12.0 / kCount));
  CHECK(std::abs(squares / kCount - 1.0 / 12.0) < 5.0 * std::sqrt(1.0 / 180.0 / kCount));
  const double expected = static_cast<double>(kCount) / kBins;
  double chi2 = 0.0;
  for (const int count : bins) chi2 += (count - expected) * (count - expected) / expected;
  // Chi-square with 63 degrees: mean 63, deviation sqrt(126) = 11.2; five of them each side.
  CHECK(chi2 > 63.0 - 56.0);
  CHECK(chi2 < 63.0 + 56.0);
}

TEST_CASE("uniform01: neighbouring seeds and neighbouring counters are uncorrelated") {
  constexpr int kCount = 100000;
  double by_seed = 0.0, by_counter = 0.0;
  for (std::uint64_t n = 0; n < kCount; ++n) {
    by_seed += uniform11(5, n) * uniform11(6, n);
    by_counter += uniform11(5, n) * uniform11(5, n + 1);
  }
  // A product of two independent values in [-1, 1) has variance 1/9; five deviations.
  const double bound = 5.0 / 3.0 / std::sqrt(static_cast<double>(kCount));
  CHECK(std::abs(by_seed / kCount) < bound);
  CHECK(std::abs(by_counter / kCount) < bound);
}

TEST_CASE("Hash64: a change of any one bit of any one word changes the hash") {
  const std::uint64_t plain = hash_of({1, 2, 3});
  for (int bit = 0; bit < 64; ++bit) {
    CAPTURE(bit);
    const std::uint64_t flip = 1ull << bit;
    CHECK(hash_of({1 ^ flip, 2, 3}) != plain);
    CHECK(hash_of({1, 2 ^ flip, 3}) != plain);
    CHECK(hash_of({1, 2, 3 ^ flip}) != plain);
  }
}

TEST_CASE("Hash64: order and length count, and 100000 short inputs do not collide") {
  CHECK(hash_of({1, 2}) != hash_of({2, 1}));
  CHECK(hash_of({}) != hash_of({0}));
  CHECK(hash_of({0}) != hash_of({0, 0}));
  std::set<std::uint64_t> seen;
  for (std::uint64_t n = 0; n < 50000; ++n) {
    seen.insert(hash_of({n}));
    seen.insert(hash_of({n, n}));
  }
  CHECK(seen.size() == 100000);
}

TEST_CASE("Hash64: floating-point values count by their bits, hex is sixteen digits") {
  Hash64 zero, minus_zero, number;
  zero.add(0.0);
  minus_zero.add(-0.0);
  number.add(std::uint64_t{0});
  CHECK(zero.value() != minus_zero.value());
  CHECK(zero.value() == number.value());
  Hash64 vector, parts;
  vector.add(Vec3(1.0, 2.0, 3.0));
  for (const double part : {1.0, 2.0, 3.0}) parts.add(part);
  CHECK(vector.value() == parts.value());
  CHECK(zero.hex().size() == 16);
  CHECK(std::stoull(zero.hex(), nullptr, 16) == zero.value());
}
