#include "core/drill/spindle.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/drill/energy.h"

using namespace burrhole;

namespace {

constexpr SpindleConfig kConfig{.free_speed = 1000.0 / 60.0, .stall_torque = 2.0, .inertia = 1e-3};

Spindle make(const SpindleConfig& config = kConfig) {
  auto spindle = Spindle::create(config);
  REQUIRE(spindle.ok());
  return *spindle;
}

}  // namespace

TEST_CASE("spindle: create refuses numbers that are not above 0, and an inertia below 0") {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, inf}) {
    CHECK_FALSE(Spindle::create({.free_speed = bad}).ok());
    CHECK_FALSE(Spindle::create({.stall_torque = bad}).ok());
    if (bad != 0.0) CHECK_FALSE(Spindle::create({.inertia = bad}).ok());
  }
  CHECK(Spindle::create({.inertia = 0.0}).ok());
}

TEST_CASE("spindle: settles on the motor's straight line and stalls at the stall torque") {
  for (const double torque : {0.0, 0.5, 1.0, 1.9}) {
    Spindle spindle = make();
    for (int n = 0; n < 100; ++n) spindle.step(torque, spindle.time_constant());
    CHECK(std::abs(spindle.speed() - kConfig.free_speed * (1.0 - torque / 2.0)) < 1e-12);
    CHECK(spindle.steady_speed(torque) == doctest::Approx(spindle.speed()).epsilon(1e-12));
  }
  for (const double torque : {2.5, 100.0}) {
    Spindle spindle = make();
    for (int n = 0; n < 10; ++n) CHECK(spindle.step(torque, spindle.time_constant()) >= 0.0);
    CHECK(spindle.speed() == 0.0);
    CHECK(spindle.steady_speed(torque) == 0.0);
  }
}

TEST_CASE("spindle: the lag is the closed form, in one step as in a thousand") {
  const double tau = 2.0 * std::numbers::pi * 1e-3 * kConfig.free_speed / 2.0;
  CHECK(make().time_constant() == doctest::Approx(tau).epsilon(1e-14));
  const double steady = kConfig.free_speed * 0.6, exact = steady + (kConfig.free_speed - steady) * std::exp(-1.7);
  for (const int steps : {1, 10, 1000}) {
    Spindle spindle = make();
    for (int n = 0; n < steps; ++n) spindle.step(0.8, 1.7 * tau / steps);
    CHECK(std::abs(spindle.speed() - exact) < 1e-12 * steps + 1e-12);  // a rounding a step
  }
}

TEST_CASE("spindle: overloaded it reaches 0 when the closed form says, stays there and comes back") {
  Spindle spindle = make();
  const double tau = spindle.time_constant();
  const double to_stall = tau * std::log(3.0 / 2.0 / (1.0 / 2.0));  // M = 3: n_steady = -n0 / 2
  spindle.step(3.0, 0.999 * to_stall);
  CHECK(spindle.speed() > 0.0);
  spindle.step(3.0, 0.002 * to_stall);
  CHECK(spindle.speed() == 0.0);
  CHECK(spindle.step(2.0, 10.0 * tau) == 0.0);
  CHECK(spindle.step(0.0, tau) == doctest::Approx(kConfig.free_speed * (1.0 - std::exp(-1.0))).epsilon(1e-12));
}

TEST_CASE("spindle: without inertia it follows at once, and torques that are no number count as none") {
  Spindle spindle = make({.inertia = 0.0});
  CHECK(spindle.step(1.0, 1e-3) == doctest::Approx(0.5 * spindle.steady_speed(0.0)).epsilon(1e-14));
  CHECK(spindle.step(std::nan(""), 1e-3) == spindle.steady_speed(0.0));
  CHECK(spindle.step(-5.0, 1e-3) == spindle.steady_speed(0.0));
  CHECK(spindle.step(1.0, 0.0) == spindle.steady_speed(0.0));
  spindle.set_speed(-3.0);
  CHECK(spindle.speed() == 0.0);
}

TEST_CASE("spindle: work of the motor's torque goes into the flywheel and the cut") {
  // Energy balance: the integral of (M_m - M) 2 pi n dt is the change of I (2 pi n)^2 / 2.
  Spindle spindle = make();
  const double dt = 1e-5, torque = 1.2, turn = 2.0 * std::numbers::pi;
  double work = 0.0;
  const auto kinetic = [&] { return 0.5 * kConfig.inertia * std::pow(turn * spindle.speed(), 2.0); };
  const double before = kinetic();
  for (int n = 0; n < 4000; ++n) {
    const double start = spindle.speed(), end = spindle.step(torque, dt), middle = 0.5 * (start + end);
    work += (2.0 * (1.0 - middle / kConfig.free_speed) - torque) * turn * middle * dt;
  }
  CHECK(std::abs(work - (kinetic() - before)) < 1e-6 * before);  // midpoint rule: error of order (dt / tau)^2
}

TEST_CASE("spindle: the cutting torque is mu F r, and the tool's radius its points' by factor") {
  CHECK(cutting_torque(0.5, 20.0, 3e-3) == doctest::Approx(0.03).epsilon(1e-14));
  const ErosionPoints points{.pitch = 1e-3, .positions = {Vec3(3e-3, 4e-3, 1e-3), Vec3(0.0, -1e-3, 7e-3)}, .factors = {1.0f, 3.0f}};
  CHECK(rubbing_radius(points) == doctest::Approx((5e-3 + 3e-3) / 4.0).epsilon(1e-12));
  CHECK(rubbing_radius({}) == 0.0);
}
