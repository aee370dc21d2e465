// Rinsing and clearing against their closed forms and plain twins in fine steps.

#include "core/debris/wash.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace burrhole::test {
namespace {

double twin(double wet, const WashRate& rate, double t, int steps) {
  const double before = wet;
  for (int n = 0; n < steps; ++n) wet -= t / steps * std::min(wet / rate.time, rate.most);
  return before - wet;
}

}  // namespace

TEST_CASE("wash: with much saline the rest is e^(-t / tau), with little it carries its load, and in between both after each other") {
  CHECK(washed(2.0, {.time = 0.5, .most = 10.0}, 0.25) == doctest::Approx(2.0 * (1.0 - std::exp(-0.5))).epsilon(1e-14));
  CHECK(washed(2.0, {.time = 0.5, .most = 0.1}, 0.25) == doctest::Approx(0.025).epsilon(1e-14));
  // 2 - 1 at the rate 2 in 0.5 s, then e^(-0.5 / 0.5).
  CHECK(washed(2.0, {.time = 0.5, .most = 2.0}, 1.0) == doctest::Approx(1.0 + (1.0 - std::exp(-1.0))).epsilon(1e-14));
  CHECK(washed(2.0, {.time = 0.5, .most = 0.0}, 1.0) == 0.0);
  CHECK(washed(0.0, {.time = 0.5, .most = 1.0}, 1.0) == 0.0);
  CHECK(washed(1.0, {.time = 1e-9, .most = 1e9}, 1.0) <= 1.0);
}

TEST_CASE("wash: many short steps equal one long step, and a plain twin in fine steps") {
  for (const double most : {0.3, 1.0, 20.0}) {
    const WashRate rate{.time = 0.7, .most = most};
    const double once = washed(3.0, rate, 2.0);
    double wet = 3.0;
    for (int n = 0; n < 200; ++n) wet -= washed(wet, rate, 0.01);
    CHECK(3.0 - wet == doctest::Approx(once).epsilon(1e-12));
    // First order: an error of h / tau / 2.
    CHECK(std::abs(twin(3.0, rate, 2.0, 100000) - once) < 3.0 * 2e-5 / 0.7);
    // Sabotage: a twin that takes twice as long.
    CHECK(std::abs(twin(3.0, {.time = 1.4, .most = 0.5 * most}, 2.0, 100000) - once) > 1e-2);
  }
}

TEST_CASE("wash: what a bit holds decays by e^(-k t) and comes to inflow / k, in one step or in many") {
  CHECK(held_after(3.0, 0.0, 0.4) == doctest::Approx(3.0 * std::exp(-0.4)).epsilon(1e-14));
  CHECK(held_after(0.0, 2.0, 0.0) == 2.0);
  CHECK(held_after(1.0, 0.5, 1e-7) == doctest::Approx(1.5 - 1.25e-7).epsilon(1e-12));
  const double once = held_after(1.0, 5.0, 3.0);
  double held = 1.0;
  for (int n = 0; n < 300; ++n) held = held_after(held, 5.0 / 300.0, 0.01);
  CHECK(held == doctest::Approx(once).epsilon(1e-12));
  // 100 ms at extreme speed: what arrives while it is cleared, inflow / k.
  CHECK(held_after(9.0, 1.0, 1e4) == doctest::Approx(1e-4).epsilon(1e-12));
}

}  // namespace burrhole::test
