#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "app/lab/frontier.h"

using namespace burrhole;

TEST_CASE("frontier oracle: the spectral radius of a turn, a defective block and a nilpotent matrix is the closed form's") {
  const double c = 0.9 * std::cos(0.7), s = 0.9 * std::sin(0.7);
  CHECK(log_spectral_radius({2, {c, -s, s, c}}) == doctest::Approx(std::log(0.9)).epsilon(1e-9));
  // A Jordan block's powers grow as n: log n / n is left of it after 2^40 factors.
  CHECK(log_spectral_radius({2, {0.99, 1.0, 0.0, 0.99}}) == doctest::Approx(std::log(0.99)).epsilon(1e-6));
  CHECK(std::isinf(log_spectral_radius({2, {0.0, 1.0, 0.0, 0.0}})));
}

TEST_CASE("frontier oracle: the exact systems have the limits that closed forms of the pulse transfer function give") {
  REQUIRE(known_limits().size() == 52);
  for (const KnownLimit& known : known_limits()) {
    CAPTURE(std::string(known.name));
    // Half of the last whole number, and the width of exact_stability_limit()'s bisection.
    CHECK(std::abs(exact_stability_limit(wall_of(loop_of(known))) - known.stiffness) < 0.5 + 1e-6 * known.stiffness);
  }
  // Sabotage: a tick of delay more is another figure.
  SampledWall late = wall_of(loop_of(known_limits()[2]));
  ++late.delay;
  CHECK(std::abs(exact_stability_limit(late) - known_limits()[2].stiffness) > 1000.0);
}

TEST_CASE("frontier oracle: the passive line is the printed one with and without delay, and with a plain difference") {
  // Sampled in 4000 frequencies: the bound at none of them is off by more than their distance squared.
  CHECK(passive_limit({}, 5.0) == doctest::Approx(2.0 * 5.0 / 1e-3).epsilon(1e-5));
  CHECK(passive_limit({.delay = 1}, 5.0) == doctest::Approx(5.0 / 1.5e-3).epsilon(1e-5));
  CHECK(passive_limit({.delay = 1, .latency_ticks = 1}, 5.0) == doctest::Approx(5.0 / 2.5e-3).epsilon(1e-5));
  CHECK(passive_limit({.wall_damping = 2.0}, 5.0) == doctest::Approx(2.0 * (5.0 - 2.0) / 1e-3).epsilon(1e-5));
  CHECK(passive_limit({.wall_damping = 6.0}, 5.0) == 0.0);
}

TEST_CASE("frontier oracle: the quantised line takes the smaller of its terms, and none where positions are exact") {
  CHECK(*quantised_passive_limit(0.5, 0.05, 0.05e-3, 1e-3) == doctest::Approx(1000.0));
  CHECK(*quantised_passive_limit(5.0, 0.05, 0.05e-3, 1e-3) == doctest::Approx(2000.0));
  CHECK(!quantised_passive_limit(5.0, 0.05, 0.0, 1e-3));
}
