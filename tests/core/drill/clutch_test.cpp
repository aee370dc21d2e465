// The clutch of a perforator against closed forms, and with each of its failures.

#include "core/drill/clutch.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

constexpr double kSpin = 1000.0 / 60.0;  // [rev/s]
constexpr double kNone = std::numeric_limits<double>::infinity();

Clutch make(const ClutchConfig& config = {}) {
  auto clutch = Clutch::create(config);
  REQUIRE(clutch.ok());
  return *clutch;
}

/// A clutch that 28 N on its tip have engaged for a second.
Clutch engaged(const ClutchConfig& config = {}) {
  Clutch clutch = make(config);
  for (int n = 0; n < 100; ++n) clutch.step(28.0, kSpin, 0.01);
  REQUIRE(clutch.state() == ClutchState::engaged);
  REQUIRE(clutch.pushed_back() == config.travel);
  return clutch;
}

/// [s] from the loss of all support to the release, in steps of `dt`; infinite: none in 100 s.
double release_after(Clutch clutch, double dt, double spin = kSpin) {
  const double from = clutch.time();
  while (clutch.time() < from + 100.0) {
    clutch.step(0.0, spin, dt);
    if (clutch.releases() > 0) return *clutch.released_at() - from;
  }
  return kNone;
}

/// The closed form: the inner drill goes forward from the end of its travel until the teeth part.
double closed_form(const ClutchConfig& c) {
  const double k = (1.0 - c.wear) * c.stiffness;
  return c.damping / k * std::log(c.engage_force / (c.engage_force - c.stiffness * c.teeth)) + c.release_delay;
}

}  // namespace

TEST_CASE("clutch: create refuses what is not in its range, and a spring that would hold the inner drill back") {
  const double nan = std::nan("");
  for (const double bad : {0.0, -1.0, nan, kNone}) {
    CHECK_FALSE(Clutch::create({.engage_force = bad}).ok());
    CHECK_FALSE(Clutch::create({.stiffness = bad}).ok());
    CHECK_FALSE(Clutch::create({.travel = bad}).ok());
    CHECK_FALSE(Clutch::create({.teeth = bad}).ok());
  }
  for (const double bad : {-1.0, nan, kNone}) {
    CHECK_FALSE(Clutch::create({.damping = bad}).ok());
    CHECK_FALSE(Clutch::create({.inner_stop = bad}).ok());
    CHECK_FALSE(Clutch::create({.outer_stop = bad}).ok());
    CHECK_FALSE(Clutch::create({.release_delay = bad}).ok());
    CHECK_FALSE(Clutch::create({.least_spin = bad}).ok());
    CHECK_FALSE(Clutch::create({.wear = bad}).ok());
  }
  CHECK_FALSE(Clutch::create({.wear = 1.01}).ok());
  CHECK_FALSE(Clutch::create({.travel = 1e-3, .teeth = 1e-3}).ok());
  CHECK_FALSE(Clutch::create({.engage_force = 4.0, .stiffness = 3000.0, .travel = 1.5e-3}).ok());
  CHECK(Clutch::create({.engage_force = 4.5, .stiffness = 3000.0, .travel = 1.5e-3}).ok());
}

TEST_CASE("clutch: a tip that loses its support stops the drill after c/k ln(F_engage/F_release), whatever the step") {
  for (const ClutchConfig& config : {ClutchConfig{}, ClutchConfig{.damping = 400.0}, ClutchConfig{.teeth = 0.5e-3},
                                     ClutchConfig{.wear = 0.7}, ClutchConfig{.damping = 0.0}, ClutchConfig{.release_delay = 0.25}}) {
    const double exact = closed_form(config);
    for (const double dt : {1e-4, 1e-3, 4e-3, 0.02, 0.1}) {
      CAPTURE(dt);
      // Exact in each step: a rounding of 1e-16 of x a step, of which a step of 1e-4 s has 2600 at most, over dx/dt of x/0.02 s: below 1e-12 s.
      CHECK(std::abs(release_after(engaged(config), dt) - exact) < 1e-11);
    }
  }
  // Sabotage: without the spring's fall over the teeth (c times the teeth over F) the same check fails by far.
  const ClutchConfig c;
  CHECK(std::abs(c.damping * c.teeth / c.engage_force - closed_form(c)) > 1e-4);
}

TEST_CASE("clutch: under a falling reaction it releases where a twin in steps of 1 us does, with an error below a step") {
  const ClutchConfig config{.damping = 200.0};
  constexpr double kFall = 40.0;  // [N/s] from 28 N
  double x = config.travel, t = 0.0;
  const double preload = config.engage_force - config.stiffness * config.travel, part = config.travel - config.teeth;
  for (; x >= part; t += 1e-6) x = std::min(config.travel, x + 1e-6 / config.damping * (28.0 - kFall * t - preload - config.stiffness * x));
  for (const double dt : {1e-3, 0.01, 0.02}) {
    Clutch clutch = engaged(config);
    const double from = clutch.time();
    for (int n = 0; clutch.releases() == 0; ++n)
      clutch.step(28.0 - kFall * dt * n, kSpin, dt);  // the reaction at the step's start: late by a step
    const double error = *clutch.released_at() - from - t;
    CHECK(error > -1e-4);  // of the twin's own steps
    CHECK(error < dt);
  }
  // Without damping the instant is where the reaction meets the release force.
  Clutch quick = engaged({.damping = 0.0});
  const double from = quick.time(), meets = (28.0 - quick.release_force()) / kFall;
  for (int n = 0; quick.releases() == 0; ++n) quick.step(28.0 - kFall * 1e-3 * n, kSpin, 1e-3);
  CHECK(*quick.released_at() - from >= meets);
  CHECK(*quick.released_at() - from < meets + 1e-3 + 1e-9);
}

TEST_CASE("clutch: it engages at its force and not below, stays engaged down to the release force, and engages again on load") {
  for (const double wear : {0.0, 0.5}) {
    const ClutchConfig config{.wear = wear};
    const auto after = [&](Clutch clutch, double force) {
      for (int n = 0; n < 1000; ++n) clutch.step(force, kSpin, 0.01);
      return clutch;
    };
    const Clutch fresh = make(config);
    CHECK(fresh.engage_force() == doctest::Approx(12.0 * (1.0 - wear)).epsilon(1e-15));
    CHECK(fresh.release_force() == doctest::Approx(9.0 * (1.0 - wear)).epsilon(1e-15));
    CHECK_FALSE(after(fresh, 0.99 * fresh.engage_force()).engaged());
    CHECK(after(fresh, fresh.engage_force()).engaged());
    const Clutch on = engaged(config);
    CHECK(after(on, 1.01 * on.release_force()).engaged());
    const Clutch off = after(on, 0.99 * on.release_force());
    CHECK_FALSE(off.engaged());
    CHECK_FALSE(off.turns());
    const Clutch again = after(off, 28.0);
    CHECK(again.engaged());
    CHECK(again.engagements() == 2);
    CHECK(again.releases() == 1);
  }
}

TEST_CASE("clutch: failures: late release, worn spring, no change at low speed") {
  const double usual = release_after(engaged(), 1e-3);
  CHECK(release_after(engaged({.release_delay = 0.4}), 1e-3) == doctest::Approx(usual + 0.4).epsilon(1e-9));
  CHECK(release_after(engaged({.wear = 0.5}), 1e-3) == doctest::Approx(2.0 * usual).epsilon(1e-9));
  CHECK(release_after(engaged({.wear = 1.0}), 0.01) == kNone);  // no spring: it never releases
  CHECK(release_after(engaged({.least_spin = 10.0}), 1e-3) == doctest::Approx(usual).epsilon(1e-9));
  CHECK(release_after(engaged({.least_spin = 10.0}), 0.01, 9.9) == kNone);
  Clutch slow = make({.least_spin = 10.0});
  for (int n = 0; n < 100; ++n) slow.step(28.0, 9.9, 0.01);
  CHECK_FALSE(slow.engaged());
  slow.step(28.0, 10.0, 0.01);
  CHECK(slow.engaged());
  // A tip that finds bone again before a late release keeps the clutch, and the delay starts anew.
  Clutch late = engaged({.release_delay = 0.4});
  for (int n = 0; n < 300; ++n) late.step(0.0, kSpin, 1e-3);
  CHECK(late.state() == ClutchState::holding);
  CHECK(late.engaged());
  for (int n = 0; n < 300; ++n) late.step(28.0, kSpin, 1e-3);
  CHECK(late.state() == ClutchState::engaged);
  for (int n = 0; n < 400; ++n) late.step(0.0, kSpin, 1e-3);
  CHECK(late.releases() == 0);
  for (int n = 0; n < 20; ++n) late.step(0.0, kSpin, 1e-3);
  CHECK(late.releases() == 1);
}

TEST_CASE("clutch: after the release the drills turn by half their time of running down, in steps of any length") {
  const ClutchConfig config{.inner_stop = 0.06, .outer_stop = 0.15};
  for (const double dt : {1e-3, 0.02, 0.1, 1.0}) {
    CAPTURE(dt);
    Clutch clutch = engaged(config);
    double inner = 0.0, outer = 0.0, coupled = 0.0;
    for (double t = 0.0; t < 2.0; t += dt) {
      const ClutchDrive drive = clutch.step(0.0, kSpin, dt);
      inner += drive.inner * dt;
      outer += drive.outer * dt;
      coupled += drive.coupled * dt;
    }
    CHECK(coupled == doctest::Approx(closed_form(config)).epsilon(1e-9));
    CHECK(inner - coupled == doctest::Approx(0.03).epsilon(1e-9));
    CHECK(outer - coupled == doctest::Approx(0.075).epsilon(1e-9));
    CHECK_FALSE(clutch.turns());
  }
}

TEST_CASE("clutch: numbers that are no reaction, and steps from 1 ns to a year, leave a finite state within the travel") {
  std::uint64_t draw = 0;
  const auto random = [&] { return uniform01(11, draw++); };
  MESSAGE("seed 11");
  for (const ClutchConfig& config : {ClutchConfig{}, ClutchConfig{.damping = 0.0}, ClutchConfig{.wear = 1.0}, ClutchConfig{.damping = 1e6},
                                     ClutchConfig{.inner_stop = 0.1, .release_delay = 0.05}}) {
    Clutch clutch = make(config);
    for (int n = 0; n < 20000; ++n) {
      const double dt = std::pow(10.0, -9.0 + 16.0 * random());
      const double force = n % 7 == 0 ? std::nan("") : n % 11 == 0 ? kNone : n % 13 == 0 ? -5.0 : 40.0 * random();
      const ClutchDrive drive = clutch.step(force, kSpin * random(), dt);
      REQUIRE(clutch.pushed_back() >= 0.0);
      REQUIRE(clutch.pushed_back() <= config.travel);
      for (const double share : {drive.inner, drive.outer, drive.coupled}) {
        REQUIRE(share >= 0.0);
        REQUIRE(share <= 1.0 + 1e-12);
      }
      REQUIRE(drive.inner >= drive.coupled);
    }
    CHECK(clutch.engagements() >= clutch.releases());
    CHECK(clutch.engagements() <= clutch.releases() + 1);
    CHECK(clutch.engagements() > 0);
  }
}

TEST_CASE("clutch: reset brings it to its start but keeps its counts") {
  Clutch clutch = engaged();
  clutch.reset();
  CHECK_FALSE(clutch.turns());
  CHECK(clutch.pushed_back() == 0.0);
  CHECK(clutch.releases() == 0);
  CHECK(clutch.engagements() == 1);
}
