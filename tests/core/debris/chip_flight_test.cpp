// Flight of a chip against the closed forms of Stokes' drag and of a fall with linear and quadratic drag, and a plain twin in fine steps.

#include "core/debris/chip_flight.h"

#include <doctest/doctest.h>

#include <cmath>

namespace burrhole::test {
namespace {

/// A fall from rest, dv/dt = g - a v - b v^2: with v1 = terminal speed, k = sqrt(a^2 + 4 b g), r = v1 / (v1 + a / b), E = e^-kt:
/// v = v1 (1 - E) / (1 + r E), z = v1 (t + (1 + r) / (r k) ln((1 + r E) / (1 + r))).
struct Fall {
  double speed, way;
};
Fall fall(const ChipDrag& drag, double g, double t) {
  const double k = std::sqrt(drag.linear * drag.linear + 4.0 * drag.quadratic * g), end = (k - drag.linear) / (2.0 * drag.quadratic);
  const double r = end / (end + drag.linear / drag.quadratic), e = std::exp(-k * t);
  return {end * (1.0 - e) / (1.0 + r * e), end * (t + (1.0 + r) / (r * k) * std::log((1.0 + r * e) / (1.0 + r)))};
}

Fall simulated(const ChipDrag& drag, double g, double t, int steps) {
  Vec3 velocity(0.0), place(0.0);
  for (int n = 0; n < steps; ++n) place += advance_chip(drag, Vec3(0.0, 0.0, -g), t / steps, velocity);
  return {-velocity.z, -place.z};
}

/// Runge-Kutta of fourth order, which shares no code with advance_chip().
Vec3 twin(const ChipDrag& drag, const Vec3& gravity, double t, int steps, Vec3 velocity) {
  const auto slope = [&](const Vec3& v) { return gravity - (drag.linear + drag.quadratic * glm::length(v)) * v; };
  Vec3 place(0.0);
  const double h = t / steps;
  for (int n = 0; n < steps; ++n) {
    const Vec3 v1 = velocity, v2 = v1 + 0.5 * h * slope(v1), v3 = v1 + 0.5 * h * slope(v2), v4 = v1 + h * slope(v3);
    place += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    velocity += h / 6.0 * (slope(v1) + 2.0 * slope(v2) + 2.0 * slope(v3) + slope(v4));
  }
  return place;
}

}  // namespace

TEST_CASE("chip flight: fine chips follow Stokes' closed form at any step") {
  ChipDrag drag = chip_drag({}, 15e-6);
  drag.quadratic = 0.0;
  const Vec3 gravity(0.0, 0.0, -9.81), start(0.7, -0.2, 0.3);
  for (const double t : {1e-5, 1e-3, 0.1}) {
    Vec3 velocity = start;
    const Vec3 way = advance_chip(drag, gravity, t, velocity);
    const double decay = std::exp(-drag.linear * t);
    const Vec3 end = gravity / drag.linear, expected = end + (start - end) * decay;
    // 18 mu / (rho d^2) = 758 / s: at 1e-5 s the difference 1 - e^-0.0076 loses two digits.
    CHECK(glm::length(velocity - expected) < 1e-13);
    CHECK(glm::length(way - (end * t + (start - end) * (1.0 - decay) / drag.linear)) < 1e-13 * t + 1e-16);
  }
  CHECK(drag.linear == doctest::Approx(18.0 * 1.8e-5 / (1900.0 * 15e-6 * 15e-6)));
  CHECK(terminal_speed(drag, 9.81) == doctest::Approx(9.81 / drag.linear).epsilon(1e-12));
}

TEST_CASE("chip flight: a fall has the closed form's speed and way, with an error of second order, and its terminal speed") {
  for (const double diameter : {50e-6, 200e-6, 1e-3}) {
    const ChipDrag drag = chip_drag({}, diameter);
    const double time = 1.0 / (drag.linear + drag.quadratic);  // [s] in which it speeds up
    const Fall truth = fall(drag, 9.81, time);
    const Fall coarse = simulated(drag, 9.81, time, 8), fine = simulated(drag, 9.81, time, 16);
    // The rate changes by less than itself over the fall: an error of second order is below (1/8)^2 of the value.
    CHECK(std::abs(coarse.way - truth.way) < truth.way / 64.0);
    CHECK(std::abs(coarse.speed - truth.speed) < truth.speed / 64.0);
    // Half the step, a quarter of the error; the next order may change that by a third.
    CHECK(std::abs(coarse.way - truth.way) / std::abs(fine.way - truth.way) == doctest::Approx(4.0).epsilon(0.33));
    // A sphere's terminal speed, reached in steps of 100 ms.
    const double end = terminal_speed(drag, 9.81);
    CHECK(drag.linear * end + drag.quadratic * end * end == doctest::Approx(9.81).epsilon(1e-12));
    CHECK(simulated(drag, 9.81, 100.0, 1000).speed == doctest::Approx(end).epsilon(1e-9));
  }
}

TEST_CASE("chip flight: a thrown chip follows a plain twin, and a twin without quadratic drag does not") {
  const ChipDrag drag = chip_drag({}, 300e-6);
  const Vec3 gravity(0.0, 0.0, -9.81), start(12.0, 3.0, 6.0);
  const double time = 0.05;
  const Vec3 truth = twin(drag, gravity, time, 20000, start);
  Vec3 velocity = start, place(0.0);
  for (int n = 0; n < 50; ++n) place += advance_chip(drag, gravity, time / 50, velocity);
  // Second order in the step of 1 ms: (rate h)^2, the rate at first a + b |v|.
  const double bound = std::pow(drag.rate(start) * 1e-3, 2.0);
  CHECK(glm::length(place - truth) < bound * glm::length(truth));
  const Vec3 sabotaged = twin({drag.linear, 0.0}, gravity, time, 20000, start);
  CHECK(glm::length(place - sabotaged) > 10.0 * bound * glm::length(truth));
}

TEST_CASE("chip flight: steps of 1 to 100 ms at any speed are finite and never speed a chip up beyond its start and its fall") {
  for (const double diameter : {1e-6, 100e-6, 5e-3})
    for (const double speed : {0.0, 1.0, 200.0})
      for (const double dt : {1e-3, 0.02, 0.1}) {
        const ChipDrag drag = chip_drag({}, diameter);
        Vec3 velocity(speed, 0.0, 0.0);
        for (int n = 0; n < 50; ++n) {
          const Vec3 way = advance_chip(drag, Vec3(0.0, 0.0, -9.81), dt, velocity);
          REQUIRE(is_finite(way));
          REQUIRE(velocity.x >= 0.0);
          REQUIRE(velocity.x <= speed);
          REQUIRE(glm::length(way) <= (speed + 9.81 * 50.0 * 0.1) * dt);
        }
      }
}

}  // namespace burrhole::test
