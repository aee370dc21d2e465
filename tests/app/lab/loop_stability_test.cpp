// The stability model that scenes are checked with, against the oracle, which shares no code with it: the known limits, and random loops.
#include "haptics/servo/loop_stability.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "app/lab/frontier.h"
#include "core/base/random.h"

using namespace burrhole;

namespace {

ForceLoop loop_like(const SampledWall& wall, double stiffness) {
  return {.body = {wall.mass, wall.damping, wall.hand_stiffness},
          .period = wall.period,
          .reading_delay = wall.delay,
          .true_velocity = wall.true_velocity,
          .velocity_time = wall.velocity_time,
          .contact_ticks = wall.contact_ticks,
          .latency_ticks = wall.latency_ticks,
          .scheme = wall.scheme,
          .stiffness = stiffness,
          .damping = wall.wall_damping};
}

/// A loop of the sizes that scenes may have; stiffness from a tenth to ten times the linear rule.
struct RandomLoop {
  SampledWall wall;
  double stiffness;
};
RandomLoop random_loop(std::uint64_t seed) {
  std::uint64_t n = 0;
  const auto from_to = [&](double low, double high) { return low * std::pow(high / low, uniform01(seed, n++)); };
  const auto whole = [&](int most) { return static_cast<int>(uniform01(seed, n++) * (most + 1)); };
  RandomLoop out;
  SampledWall& w = out.wall;
  w.mass = from_to(0.005, 2.0);
  w.damping = from_to(0.3, 20.0);
  w.hand_stiffness = whole(2) == 0 ? 0.0 : from_to(50.0, 2000.0);
  w.period = from_to(1e-4, 4e-3);
  w.delay = whole(4);
  w.contact_ticks = 1 + whole(1) * whole(9);
  w.latency_ticks = whole(1) * whole(20);
  w.scheme = static_cast<MultiRateScheme>(whole(3));
  w.wall_damping = whole(2) == 0 ? 0.0 : from_to(0.1, 30.0);
  w.velocity_time = whole(1) * from_to(1e-4, 5e-3);
  w.true_velocity = whole(3) == 0;
  const double late = w.period * (0.5 * w.contact_ticks + w.delay + w.latency_ticks);
  out.stiffness = from_to(0.1, 10.0) * (w.damping + w.wall_damping) / late;
  return out;
}

}  // namespace

TEST_CASE("loop stability: every known limit is met, and one more tick of delay misses it") {
  for (const KnownLimit& known : known_limits()) {
    CAPTURE(std::string(known.name));
    const SampledWall wall = wall_of(loop_of(known));
    // Half of the last whole number, and the width of the bisection. The bracket from which it starts is above the limit.
    ForceLoop loop = loop_like(wall, 1.04 * known.stiffness);
    REQUIRE(!is_stable(loop));
    const double found = limit_below(loop, &ForceLoop::stiffness);
    CHECK(std::abs(found - known.stiffness) < 0.5 + 2e-6 * known.stiffness);
    ++loop.reading_delay;  // sabotage: a limit that does not see the delay would stay
    CHECK(std::abs(limit_below(loop, &ForceLoop::stiffness) - known.stiffness) > 1.0);
  }
}

// The oracle's radius has an error of log n / n at n = 2^40 factors for a defective matrix, below 1e-9, and rounding that 40 squarings of a
// matrix of up to 40 rows add: 40 * 40 * 2^-53 times the condition of its eigenvectors, which for clustered delays reaches 1e4: 2e-9. The
// model bisects to 1e-9. A zero of multiplicity 2 splits by the square root of rounding, 1e-8. In all 1e-7.
TEST_CASE("loop stability: random loops have the oracle's spectral radius and its verdict") {
  int unstable = 0, compared = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const RandomLoop at = random_loop(seed);
    CAPTURE(seed);
    const ForceLoop loop = loop_like(at.wall, at.stiffness);
    const double expected = log_spectral_radius(contact_period_matrix(at.wall, at.stiffness));
    const double found = log_growth(loop);
    CHECK(found == doctest::Approx(expected).epsilon(1e-7).scale(1.0));
    if (std::abs(expected) < 1e-7) continue;
    ++compared;
    CHECK(is_stable(loop) == (expected < 0.0));
    if (expected > 0.0) ++unstable;
  }
  MESSAGE(unstable << " of " << compared << " loops are unstable");
  CHECK(unstable > 50);  // both verdicts are tested
  CHECK(compared - unstable > 50);
}

TEST_CASE("loop stability: gain times stiffness and damping is the loop of both scaled, and its limit scales") {
  ForceLoop loop{.body = {0.25, 5.0, 300.0}, .reading_delay = 1, .velocity_time = 2e-3, .stiffness = 16e3, .damping = 8.0, .gain = 1.0};
  const double limit = limit_below(loop, &ForceLoop::gain);
  ForceLoop scaled = loop;
  scaled.stiffness *= limit;
  scaled.damping *= limit;
  CHECK(is_stable(scaled));
  scaled.gain = 1.0 + 1e-5;
  CHECK(!is_stable(scaled));
  // A damper alone can be too much: a smaller stiffness does not help, a smaller damping does.
  loop = {.body = {0.25, 5.0, 300.0}, .reading_delay = 1, .velocity_time = 2e-3, .stiffness = 1429.0, .damping = 570.0};
  CHECK(!is_stable(loop));
  CHECK(limit_below(loop, &ForceLoop::stiffness) == 0.0);
  CHECK(limit_below(loop, &ForceLoop::damping) > 0.0);
}
