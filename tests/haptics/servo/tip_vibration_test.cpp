// The vibration of a turning bit against its closed form.

#include "haptics/servo/tip_vibration.h"

#include <doctest/doctest.h>

#include <complex>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kPeriod = 1e-3;  // [s]

TipVibration vibration(double amplitude, double cycles) {
  auto made = TipVibration::create({amplitude, cycles});
  REQUIRE(made.ok());
  return *made;
}

/// Size [N] of the part of the force that turns at `frequency` [Hz], over a second.
double part_at(TipVibration law, double spin, double frequency) {
  std::complex<double> sum = 0.0;
  for (int n = 1; n <= 1000; ++n) {
    const Vec3 force = law(spin, Vec3(0.0, 0.0, 1.0), kPeriod);
    sum += std::complex(force.x, force.y) * std::polar(1.0, -2.0 * std::numbers::pi * frequency * n * kPeriod);
  }
  return std::abs(sum) / 1000.0;
}

TEST_CASE("vibration: all of its force turns at the spin times the cycles per revolution") {
  for (const double cycles : {1.0, 3.0})
    for (const double spin : {20.0, 97.0}) {
      CHECK(std::abs(part_at(vibration(0.3, cycles), spin, spin * cycles) - 0.3) < 1e-9);
      CHECK(part_at(vibration(0.3, cycles), spin, spin * cycles + 5.0) < 1e-9);  // whole periods in a second cancel
      CHECK(part_at(vibration(0.3, cycles), spin, -spin * cycles) < 1e-9);       // it turns one way
    }
}

TEST_CASE("vibration: its force has one size, across the axis, and none without spin") {
  TipVibration law = vibration(0.2, 2.0);
  const Vec3 axis = glm::normalize(Vec3(1.0, -2.0, 0.5));
  for (int n = 0; n < 100; ++n) {
    const Vec3 force = law(33.3, axis, kPeriod);
    CHECK(std::abs(glm::length(force) - 0.2) < 1e-12);
    CHECK(std::abs(glm::dot(force, axis)) < 1e-12);
  }
  CHECK(law(0.0, axis, kPeriod) == Vec3(0.0));
}

TEST_CASE("vibration: a frequency that the ticks cannot represent is reduced to 0.4 of their rate") {
  CHECK(std::abs(part_at(vibration(1.0, 4.0), 900.0, 400.0) - 1.0) < 1e-9);
  CHECK_FALSE(TipVibration::create({-1.0, 1.0}).ok());
  CHECK_FALSE(TipVibration::create({1.0, 0.0}).ok());
}

}  // namespace
}  // namespace burrhole
