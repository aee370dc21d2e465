#include "haptics/servo/swing_detector.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;

/// A detector for swings of 1 N that has seen the force f(t) along one direction for some seconds.
template <class F>
SwingDetector after(double seconds, const F& force, const Vec3& along = {0.0, 0.0, 1.0}) {
  SwingDetector out({.force = 1.0, .longest = 0.2}, kPeriod);
  for (int n = 0; n < static_cast<int>(seconds / kPeriod); ++n) (void)out(along * force(n * kPeriod));
  return out;
}
double wave(double t, double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); }

}  // namespace

// A sine sampled at 1 kHz misses its crest by up to half a tick: 1 - cos(pi f T), 1.3 % at 50 Hz. Twelve swings take 6 periods to a tick.
TEST_CASE("swing detector: a sine is found with its swing and frequency, in any direction, from the start on") {
  for (const double hz : {3.0, 20.0, 50.0}) {
    CAPTURE(hz);
    const SwingDetector found = after(6.0, [&](double t) { return 10.0 + 4.0 * wave(t, hz); });
    CHECK(found.largest().force == doctest::Approx(8.0).epsilon(1.0 - std::cos(std::numbers::pi * hz * kPeriod) + 1e-9));
    CHECK(found.largest().frequency == doctest::Approx(hz).epsilon(hz * kPeriod / 6.0));
    CHECK(static_cast<double>(found.largest().tick) * kPeriod <= 1.0 / hz);
  }
  const SwingDetector aslant = after(
      2.0, [](double t) { return 4.0 * wave(t, 20.0); }, glm::normalize(Vec3(1.0, 1.0, 1.0)));
  CHECK(aslant.largest().force == doctest::Approx(8.0 / std::sqrt(3.0)).epsilon(0.01));
  const SwingDetector fastest = after(1.0, [](double t) { return std::lround(t / kPeriod) % 2 == 0 ? 2.0 : -2.0; });
  CHECK(fastest.largest().force == 4.0);
  CHECK(fastest.largest().frequency == doctest::Approx(500.0));
}

TEST_CASE("swing detector: small, slow and decaying swings, steps, ramps and noise are none") {
  CHECK(after(6.0, [](double t) { return 0.49 * wave(t, 20.0); }).largest().force == 0.0);
  CHECK(after(6.0, [](double t) { return 0.51 * wave(t, 20.0); }).largest().force > 0.0);  // the twin that is one
  CHECK(after(12.0, [](double t) { return 5.0 * wave(t, 2.0); }).largest().force == 0.0);
  // Six swings decay to 0.9 in 3 periods: exp(-3 r / f) = 0.9.
  const double rate = -std::log(SwingDetector::kLasting) * 20.0 / 3.0;
  CHECK(after(6.0, [&](double t) { return 50.0 * std::exp(-1.1 * rate * t) * wave(t, 20.0); }).largest().force == 0.0);
  CHECK(after(6.0, [&](double t) { return 50.0 * std::exp(-0.9 * rate * t) * wave(t, 20.0); }).largest().force > 0.0);
  CHECK(after(6.0, [&](double t) { return 0.01 * std::exp(rate * t) * wave(t, 20.0); }).largest().force > 0.0);  // grows
  CHECK(after(6.0, [](double t) { return t < 1.0 ? 28.0 * t : t < 3.0 ? 28.0 : 0.0; }).largest().force == 0.0);
  CHECK(after(6.0, [](double t) { return 20.0 * std::floor(2.0 * t); }).largest().force == 0.0);
  CHECK(after(20.0, [](double t) { return 10.0 + 0.49 * uniform11(1, static_cast<std::uint64_t>(t / kPeriod)); }).largest().force == 0.0);
}

TEST_CASE("swing detector: it reports while swings last, and no longer when they end; without a threshold it is off") {
  SwingDetector detector({.force = 1.0, .longest = 0.1}, kPeriod);
  bool on = false;
  for (int n = 0; n < 1000; ++n) on = detector(Vec3(0.0, 0.0, 5.0 * wave(n * kPeriod, 20.0)));
  CHECK(on);
  for (int n = 0; n < 300; ++n) on = detector(Vec3(0.0));
  CHECK_FALSE(on);
  CHECK(detector.largest().force > 0.0);
  SwingDetector off({.force = 0.0}, kPeriod);
  for (int n = 0; n < 1000; ++n) CHECK_FALSE(off(Vec3(50.0 * wave(n * kPeriod, 20.0))));
  CHECK(off.largest().force == 0.0);
}
