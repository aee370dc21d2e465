#include "core/sound/warning_tone.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace burrhole::test {
namespace {

constexpr double kRate = 48000.0;

/// A second of it, in blocks of 10 ms, each with its own nearness.
std::vector<float> sounded(WarningTone& tone, double nearness, double level) {
  std::vector<float> out(48000, 0.0f);
  for (std::size_t at = 0; at < out.size(); at += 480) tone.add(nearness, level, std::span(out).subspan(at, 480));
  return out;
}

/// Number of times that the loudness of 2 ms rises above half of the level.
int beeps(const std::vector<float>& samples, float level) {
  int count = 0;
  bool loud = false;
  for (std::size_t at = 0; at + 96 <= samples.size(); at += 96) {
    float peak = 0.0f;
    for (std::size_t n = at; n < at + 96; ++n) peak = std::max(peak, std::abs(samples[n]));
    if (!loud && peak > 0.6f * level) ++count;
    loud = peak > (loud ? 0.3f : 0.6f) * level;
  }
  return count;
}

}  // namespace

TEST_CASE("warning tone: it beeps 2 to 10 times a second by nearness, does not stop at 1, and is silent at 0") {
  for (const auto& [nearness, count] : {std::pair{0.001, 2}, std::pair{0.5, 6}, std::pair{0.999, 10}}) {
    WarningTone tone(kRate);
    CHECK(std::abs(beeps(sounded(tone, nearness, 0.2), 0.2f) - count) <= 1);  // the first and the last may be cut
  }
  WarningTone whole(kRate);
  CHECK(beeps(sounded(whole, 1.0, 0.2), 0.2f) == 1);
  WarningTone silent(kRate);
  for (const float sample : sounded(silent, 0.0, 0.2)) REQUIRE(sample == 0.0f);
  for (const float sample : sounded(silent, std::nan(""), 0.2)) REQUIRE(sample == 0.0f);
}

TEST_CASE("warning tone: it never exceeds its level, has no step, and what it is added to stays below it") {
  WarningTone tone(kRate);
  std::vector<float> all = sounded(tone, 0.7, 0.3);
  const std::vector<float> after = sounded(tone, 0.0, 0.3);
  all.insert(all.end(), after.begin(), after.end());
  // Between two samples the sine moves by at most 2 pi f / rate of its level, and the edge of a beep by 1 / (rise x rate).
  const double step = 0.3 * (2.0 * 3.1416 * WarningTone::kFrequency / kRate + 1.0 / (WarningTone::kRise * kRate));
  for (std::size_t n = 1; n < all.size(); ++n) {
    REQUIRE(std::abs(all[n]) <= 0.3f * 1.0001f);
    REQUIRE(std::abs(static_cast<double>(all[n] - all[n - 1])) <= step);
  }
  CHECK(all.back() == 0.0f);
  WarningTone other(kRate);
  std::vector<float> louder(480, 0.25f), alone(480, 0.0f);
  other.add(1.0, 0.3, louder);
  WarningTone same(kRate);
  same.add(1.0, 0.3, alone);
  for (std::size_t n = 0; n < alone.size(); ++n) REQUIRE(louder[n] == doctest::Approx(alone[n] + 0.25f));
}

}  // namespace burrhole::test
