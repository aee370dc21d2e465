#include "app/report/decimate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

struct Wave {
  std::vector<double> x, y;
};

/// A slow saw, so that no bucket is flat.
Wave make_wave(std::size_t count) {
  Wave wave;
  for (std::size_t i = 0; i < count; ++i) {
    wave.x.push_back(static_cast<double>(i) * 0.001);
    wave.y.push_back(static_cast<double>(i % 997) * 0.01);
  }
  return wave;
}

/// The sabotage twin: every n-th sample, as a careless writer would do.
std::vector<std::size_t> every_nth(std::size_t count, std::size_t wanted) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < count; i += count / wanted) kept.push_back(i);
  return kept;
}

bool keeps(const std::vector<std::size_t>& kept, std::size_t index) { return std::binary_search(kept.begin(), kept.end(), index); }

TEST_CASE("decimate: single-sample peaks survive, which taking every n-th sample loses") {
  Wave wave = make_wave(60000);
  wave.y[31337] = 500.0;
  wave.y[45678] = -500.0;
  const std::vector<std::size_t> kept = decimate(wave.x, wave.y, 300);
  CHECK(keeps(kept, 31337));
  CHECK(keeps(kept, 45678));
  const std::vector<std::size_t> careless = every_nth(wave.x.size(), 1500);
  CHECK_FALSE((keeps(careless, 31337) || keeps(careless, 45678)));
}

TEST_CASE("decimate: each bucket keeps its own lowest and highest sample") {
  const Wave wave = make_wave(20000);
  const std::size_t buckets = 40;
  const std::vector<std::size_t> kept = decimate(wave.x, wave.y, buckets);
  const double width = (wave.x.back() - wave.x.front()) / static_cast<double>(buckets);
  for (std::size_t b = 0; b < buckets; ++b) {
    // The slow twin finds a bucket's samples by testing all of them; a sample within 1e-9 of an inner edge may fall on either side.
    const double lower = b == 0 ? -1.0 : 1e-9, upper = b + 1 == buckets ? 2.0 : 1.0 - 1e-9;
    double low = 1e300, high = -1e300, kept_low = 1e300, kept_high = -1e300;
    const auto inside = [&](std::size_t i) {
      const double position = (wave.x[i] - wave.x.front()) / width - static_cast<double>(b);
      return position > lower && position < upper;
    };
    for (std::size_t i = 0; i < wave.x.size(); ++i)
      if (inside(i)) low = std::min(low, wave.y[i]), high = std::max(high, wave.y[i]);
    for (const std::size_t i : kept)
      if (inside(i)) kept_low = std::min(kept_low, wave.y[i]), kept_high = std::max(kept_high, wave.y[i]);
    CHECK(kept_low == low);
    CHECK(kept_high == high);
  }
}

TEST_CASE("decimate: indices rise, the ends stay, and no bucket keeps more than five") {
  const Wave wave = make_wave(50000);
  const std::vector<std::size_t> kept = decimate(wave.x, wave.y, 100);
  CHECK(std::adjacent_find(kept.begin(), kept.end(), std::greater_equal<>()) == kept.end());
  CHECK(kept.front() == 0);
  CHECK(kept.back() == wave.x.size() - 1);
  CHECK(kept.size() <= 500);
}

TEST_CASE("decimate: a gap stays a gap and hides no peak of its bucket") {
  Wave wave = make_wave(10000);
  wave.y[0] = std::numeric_limits<double>::quiet_NaN();
  wave.y[5000] = std::numeric_limits<double>::quiet_NaN();
  wave.y[5003] = 99.0;
  const std::vector<std::size_t> kept = decimate(wave.x, wave.y, 50);
  CHECK(keeps(kept, 0));
  CHECK(keeps(kept, 5000));
  CHECK(keeps(kept, 5003));
}

TEST_CASE("decimate: short, empty and constant-x series are whole") {
  const Wave wave = make_wave(12);
  CHECK(decimate(wave.x, wave.y, 10).size() == 12);
  CHECK(decimate({}, {}, 10).empty());
  const std::vector<double> x(100, 2.0);
  std::vector<double> y(100, 1.0);
  y[50] = 7.0;
  CHECK(keeps(decimate(x, y, 4), 50));
}

}  // namespace
}  // namespace burrhole
