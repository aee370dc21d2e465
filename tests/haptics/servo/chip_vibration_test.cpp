// The vibration by chips against its closed form: its size, its spectrum, and its band.

#include "haptics/servo/chip_vibration.h"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kPeriod = 1e-3;  // [s]
constexpr ToothLoad kLoad{.force = 4.0, .thickness = 50e-6, .teeth = 3};

ChipVibration vibration(const ChipVibrationConfig& config) {
  auto made = ChipVibration::create(config);
  REQUIRE(made.ok());
  return *made;
}
/// At its full size: after 50 time constants, exp(-50) away from it.
ChipVibration settled(const ChipVibrationConfig& config, const ToothLoad& load, double spin) {
  ChipVibration out = vibration(config);
  for (int n = 0; n < 1000; ++n) (void)out(load, spin, Vec3(0.0, 0.0, 1.0), kPeriod);
  return out;
}
/// Size [N] of the part of the force that turns at `frequency` [Hz], over a second; whole periods cancel.
double part_at(ChipVibration law, const ToothLoad& load, double spin, double frequency) {
  std::complex<double> sum = 0.0;
  for (int n = 1; n <= 1000; ++n) {
    const Vec3 force = law(load, spin, Vec3(0.0, 0.0, 1.0), kPeriod);
    sum += std::complex(force.x, force.y) * std::polar(1.0, -2.0 * std::numbers::pi * frequency * n * kPeriod);
  }
  return std::abs(sum) / 1000.0;
}

TEST_CASE("chips: the force turns with each tooth and, by the unevenness, with the bit") {
  const ChipVibrationConfig config{.fracture = 75e-6, .uneven = 0.3, .rise = 0.02};
  const double size = 4.0 * 50.0 / (50.0 + 75.0);
  for (const double spin : {17.0, 90.0}) {
    const ChipVibration law = settled(config, kLoad, spin);
    CHECK(std::abs(part_at(law, kLoad, spin, 3.0 * spin) - size) < 1e-9);
    CHECK(std::abs(part_at(law, kLoad, spin, spin) - 0.3 * size) < 1e-9);
    for (const double other : {2.0 * spin, 4.0 * spin, -spin, -3.0 * spin, 0.0}) CHECK(part_at(law, kLoad, spin, other) < 1e-9);
  }
}

TEST_CASE("chips: the size follows the load with its time constant, at any period") {
  for (const double dt : {1e-4, 1e-3, 10e-3, 100e-3}) {
    ChipVibration law = vibration({.fracture = 20e-6, .uneven = 0.0, .rise = 0.03});
    const double full = 4.0 * 50.0 / 70.0;
    for (int n = 1; n * dt < 0.35; ++n) {
      (void)law(kLoad, 5.0, Vec3(0.0, 0.0, 1.0), dt);
      CHECK(std::abs(law.size() - full * (1.0 - std::exp(-n * dt / 0.03))) < 1e-12);
    }
    const double before = law.size();
    (void)law({}, 5.0, Vec3(0.0, 0.0, 1.0), dt);  // through the bone: no chip
    CHECK(std::abs(law.size() - before * std::exp(-dt / 0.03)) < 1e-12);
  }
}

TEST_CASE("chips: a force that vibrates has the share h / (h + h_f): more of thick chips, as in soft bone") {
  const auto size = [](double thickness) { return settled({}, {1.0, thickness, 2}, 10.0).size(); };
  CHECK(std::abs(size(75e-6) - 0.5) < 1e-12);  // the default
  CHECK(size(10e-6) < 0.12);                   // sheared
  CHECK(size(200e-6) > 0.72);                  // broken
  CHECK(size(0.0) == 0.0);
}

TEST_CASE("chips: what the ticks cannot represent is left out, and is not turned into a slow force") {
  const ChipVibrationConfig config{.fracture = 75e-6, .uneven = 0.5, .rise = 0.02};
  const double size = 4.0 * 50.0 / 125.0;
  const auto at = [&](double spin, double frequency) { return part_at(settled(config, kLoad, spin), kLoad, spin, frequency); };
  CHECK(std::abs(at(150.0, 450.0) - 0.5 * size) < 1e-9);  // between 400 and 500 Hz
  // 3 x 300 Hz would appear as -100 Hz. Sabotage: sampled without a band it is all there.
  CHECK(at(300.0, -100.0) < 1e-9);
  CHECK(std::abs(at(300.0, 300.0) - 0.5 * size) < 1e-9);  // the envelope stays
  std::complex<double> sampled = 0.0;
  for (int n = 1; n <= 1000; ++n)
    sampled +=
        std::polar(size, 2.0 * std::numbers::pi * 900.0 * n * kPeriod) * std::polar(1.0, 2.0 * std::numbers::pi * 100.0 * n * kPeriod);
  CHECK(std::abs(sampled) / 1000.0 > 0.99 * size);
  for (const double frequency : {0.0, 333.0, -334.0, -1.0}) CHECK(at(1333.0, frequency) < 1e-9);  // 80,000 rpm: nothing is felt
}

TEST_CASE("chips: the force lies across the axis, is bounded, and stops with the spin") {
  const Vec3 axis = glm::normalize(Vec3(1.0, -2.0, 0.5));
  for (const double dt : {1e-4, 1e-3, 20e-3, 100e-3}) {
    ChipVibration law = vibration({});
    for (int n = 0; n < 500; ++n) {
      const double spin = n % 7 == 0 ? 0.0 : 1e-3 * std::pow(1.1, n % 200);
      const ToothLoad load{n % 3 == 0 ? 0.0 : 30.0, n % 5 == 0 ? 0.0 : 1e-3, n % 4};
      const Vec3 force = law(load, spin, axis, dt);
      CHECK(std::abs(glm::dot(force, axis)) < 1e-12);
      CHECK(glm::length(force) <= 1.2 * 30.0);
      if (spin == 0.0) CHECK(force == Vec3(0.0));
    }
  }
  for (const ChipVibrationConfig& bad :
       {ChipVibrationConfig{.fracture = 0.0}, ChipVibrationConfig{.uneven = -1.0}, ChipVibrationConfig{.rise = NAN}})
    CHECK_FALSE(ChipVibration::create(bad).ok());
}

}  // namespace
}  // namespace burrhole
