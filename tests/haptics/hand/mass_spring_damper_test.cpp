#include "haptics/hand/mass_spring_damper.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

struct State {
  double x = 0.0, v = 0.0;
};

/// m x'' + b x' + k x = u solved in long double by cases, from x0, v0 under a held u.
State closed_form(const MassSpringDamperConfig& c, const State& start, double input, double time) {
  using Real = long double;
  const Real m = c.mass, b = c.damping, k = c.stiffness, u = input, t = time, v0 = start.v;
  if (k == 0.0L && b == 0.0L) return {static_cast<double>(start.x + v0 * t + u * t * t / (2.0L * m)), static_cast<double>(v0 + u * t / m)};
  if (k == 0.0L) {
    const Real rate = b / m, rest = u / b, decayed = -std::expm1(-rate * t);
    return {static_cast<double>(start.x + rest * t + (v0 - rest) * decayed / rate), static_cast<double>(v0 + (rest - v0) * decayed)};
  }
  const Real y0 = start.x - u / k, half = b / (2.0L * m), square = half * half - k / m;
  Real y = 0.0L, v = 0.0L;
  if (square < 0.0L) {  // under-damped
    const Real w = std::sqrt(-square), e = std::exp(-half * t), s = std::sin(w * t), co = std::cos(w * t), q = (v0 + half * y0) / w;
    y = e * (y0 * co + q * s);
    v = e * ((q * w - half * y0) * co - (half * q + w * y0) * s);
  } else if (square == 0.0L) {  // critical
    const Real e = std::exp(-half * t), q = v0 + half * y0;
    y = e * (y0 + q * t);
    v = e * (q - half * (y0 + q * t));
  } else {  // over-damped: the slow root by product, so that it does not cancel
    const Real root = std::sqrt(square), fast = -half - root, slow = (k / m) / fast;
    const Real a = (v0 - fast * y0) / (slow - fast), z = y0 - a;
    y = a * std::exp(slow * t) + z * std::exp(fast * t);
    v = a * slow * std::exp(slow * t) + z * fast * std::exp(fast * t);
  }
  return {static_cast<double>(y + u / k), static_cast<double>(v)};
}

State after(const MassSpringDamperConfig& config, const State& start, double input, double period, int ticks = 1) {
  const auto body = MassSpringDamper::create(config, period);
  REQUIRE(body.ok());
  Vec3 x(start.x, 0.0, -start.x), v(start.v, 0.0, -start.v);
  for (int n = 0; n < ticks; ++n) body->step(x, v, Vec3(input, 0.0, -input));
  CHECK(x.y == 0.0);
  CHECK(x.z == -x.x);  // three independent axes
  return {x.x, v.x};
}

struct Named {
  const char* name;
  MassSpringDamperConfig config;
};
const std::vector<Named> kCases{{"under-damped, firm grip", {0.6, 10.0, 1000.0}},
                                {"under-damped, device", {0.1, 0.5, 300.0}},
                                {"critical", {0.25, 10.0, 100.0}},
                                {"over-damped", {0.05, 10.0, 100.0}},
                                {"strongly over-damped", {0.01, 20.0, 50.0}},
                                {"no spring", {0.1, 5.0, 0.0}},
                                {"no damper", {0.6, 0.0, 1000.0}},
                                {"mass alone", {0.3, 0.0, 0.0}}};

/// Lengths and speeds of the case: what an error is relative to.
State scale(const MassSpringDamperConfig& c, const State& start, double input, double t) {
  const double pulled = std::abs(input) * std::min(t * t / c.mass, c.stiffness > 0.0 ? 1.0 / c.stiffness : 1e9);
  const double length = std::abs(start.x) + std::abs(start.v) * t + pulled;
  return {length, std::abs(start.v) + length / t};
}

}  // namespace

TEST_CASE(
    "MassSpringDamper: one tick is the closed form within 1e-12, under-, over- and critically damped, without spring, without damper") {
  double worst = 0.0;
  for (const Named& named : kCases)
    for (const double period : {1e-4, 1e-3, 1e-2, 0.1})
      for (std::uint64_t n = 0; n < 20; ++n) {
        CAPTURE(std::string(named.name));
        CAPTURE(period);
        const State start{0.01 * uniform11(1, n), 0.2 * uniform11(2, n)};
        const double input = 20.0 * uniform11(3, n);
        const State expected = closed_form(named.config, start, input, period), actual = after(named.config, start, input, period);
        const State size = scale(named.config, start, input, period);
        worst = std::max({worst, std::abs(actual.x - expected.x) / size.x, std::abs(actual.v - expected.v) / size.v});
      }
  MESSAGE("largest error, relative to the motion's size " << worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("MassSpringDamper: two half ticks equal one tick, and a thousand small ones equal one large one") {
  for (const Named& named : kCases) {
    CAPTURE(std::string(named.name));
    const State start{0.004, -0.13};
    const double input = 7.0;
    for (const double period : {1e-3, 0.05}) {
      const State one = after(named.config, start, input, period), two = after(named.config, start, input, 0.5 * period, 2);
      const State size = scale(named.config, start, input, period);
      CHECK(std::abs(one.x - two.x) < 1e-12 * size.x);
      CHECK(std::abs(one.v - two.v) < 1e-12 * size.v);
    }
    const State one = after(named.config, start, input, 0.25), many = after(named.config, start, input, 0.25e-3, 1000);
    const State size = scale(named.config, start, input, 0.25);
    // A thousand roundings of the matrix' entries, each about 1e-15 of the state.
    CHECK(std::abs(one.x - many.x) < 1e-11 * size.x);
    CHECK(std::abs(one.v - many.v) < 1e-11 * size.v);
  }
}

TEST_CASE("MassSpringDamper: left alone its energy never grows, and with a damper it goes") {
  for (const Named& named : kCases)
    for (const double period : {1e-4, 1e-3, 2e-2}) {
      CAPTURE(std::string(named.name));
      const MassSpringDamperConfig& c = named.config;
      const auto body = MassSpringDamper::create(c, period);
      REQUIRE(body.ok());
      Vec3 x(0.01, -0.004, 0.0), v(0.3, 0.0, -0.2);
      const auto energy = [&] { return 0.5 * c.mass * glm::dot(v, v) + 0.5 * c.stiffness * glm::dot(x, x); };
      const double first = energy();
      double before = first, most_gained = 0.0;
      for (int n = 0; n < 5000; ++n) {
        body->step(x, v, Vec3(0.0));
        most_gained = std::max(most_gained, (energy() - before) / first);
        before = energy();
      }
      CHECK(most_gained < 1e-12);  // rounding of one tick
      if (c.damping > 0.0)
        CHECK(before < first);
      else
        CHECK(std::abs(before - first) < 5000 * 1e-12 * first);
    }
}

TEST_CASE("MassSpringDamper: under a held input it comes to rest where the spring balances it") {
  const State rest = after({0.6, 10.0, 1000.0}, {0.02, 0.5}, 28.0, 1e-3, 20000);
  CHECK(std::abs(rest.x - 0.028) < 1e-12);
  CHECK(std::abs(rest.v) < 1e-12);
}

TEST_CASE("MassSpringDamper: create refuses what is not finite or out of range") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](const MassSpringDamperConfig& config, double period) {
    const auto body = MassSpringDamper::create(config, period);
    return !body.ok() && body.error().code == ErrorCode::out_of_range;
  };
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    CHECK(refuses({bad, 1.0, 1.0}, 1e-3));
    CHECK(refuses({1.0, 1.0, 1.0}, bad));
  }
  for (const double bad : {-1e-9, nan, infinity}) {
    CHECK(refuses({1.0, bad, 1.0}, 1e-3));
    CHECK(refuses({1.0, 1.0, bad}, 1e-3));
  }
  CHECK_FALSE(refuses({1.0, 0.0, 0.0}, 1e-3));
}
