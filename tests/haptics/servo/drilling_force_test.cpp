// The drilling force: closed forms, the same at any rate, and passive. The work is summed here, from forces and motions.

#include "haptics/servo/drilling_force.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace burrhole {
namespace {

constexpr Vec3 kDown(0.0, 0.0, -1.0);
/// No limit that is reached.
constexpr PassiveForceConfig kFree{.allowance = 1e6, .acceleration = 1e-3};

DrillingForce made(const DrillingForceConfig& config) {
  auto out = DrillingForce::create(config);
  REQUIRE(out);
  return *out;
}

/// Calls f(force, time) for each tick of a motion along -z. @param depth [m] by time.
void move(DrillingForce law, double dt, double duration, const std::function<double(double)>& depth,
          const std::function<void(const Vec3&, double)>& f) {
  for (int n = 0; n * dt <= duration; ++n) f(law(depth(n * dt) * kDown, depth(n * dt) * kDown, kDown, dt), n * dt);
}

TEST_CASE("drilling force: at a constant speed it rises to k v, against the bone, with the time constant") {
  const DrillingForceConfig config{.resistance = 80.0, .time = 15e-3, .limit = kFree};
  for (const double dt : {1e-4, 1e-3, 10e-3, 100e-3})
    move(
        made(config), dt, 0.5, [](double t) { return 0.02 * t; },
        [&](const Vec3& force, double t) {
          CHECK(glm::length(force - Vec3(0.0, 0.0, 80.0 * 0.02 * (1.0 - std::exp(-t / 15e-3)))) < 1e-12);
        });
}

TEST_CASE("drilling force: its size is that of the speed whatever its direction, its direction that of the bone") {
  DrillingForce law = made({.resistance = 10.0, .time = 1e-6, .limit = kFree});
  const Vec3 towards =
      glm::normalize(Vec3(-1.0, 0.0, -1.0));  // fig. 4 of the paper: a quarter of the burr is in bone, the force turns by 45 degrees
  (void)law(Vec3(0.0), Vec3(0.0), towards, 1e-3);
  const Vec3 force = law(Vec3(0.0), Vec3(0.0, 0.0, -3e-5), towards, 1e-3);  // the hand rests: the speed is that of the drill
  CHECK(glm::length(force + 10.0 * 0.03 * towards) < 1e-12);
  CHECK(law(Vec3(0.0), Vec3(0.0, 0.0, -6e-5), Vec3(0.0), 1e-3) == Vec3(0.0));  // no bone
}

TEST_CASE("drilling force: 1 and 6 kHz give the same within 2 %") {
  // A drill moves by 5 mm at 2 Hz. The mean speed of a tick lags by half a tick, the force is held for one: 1.5 ms against 0.25 ms. Its change in
  // that time is at most 2 pi 2 Hz x 1.25 ms = 1.6 % of the peak.
  const auto depth = [](double t) { return 5e-3 * std::sin(2.0 * std::numbers::pi * 2.0 * t); };
  const double peak = 100.0 * 5e-3 * 2.0 * std::numbers::pi * 2.0;
  std::vector<double> slow, fast;
  move(made({.limit = kFree}), 1.0 / 1000.0, 1.0, depth, [&](const Vec3& force, double) { slow.push_back(force.z); });
  move(made({.limit = kFree}), 1.0 / 6000.0, 1.0, depth, [&](const Vec3& force, double) { fast.push_back(force.z); });
  double worst = 0.0, largest = 0.0, printed = 0.0;
  for (std::size_t n = 0; n < slow.size() && 6 * n < fast.size(); ++n) {
    worst = std::max(worst, std::abs(slow[n] - fast[6 * n]));
    largest = std::max(largest, fast[6 * n]);
  }
  CHECK(worst < 0.02 * peak);
  CHECK(largest > 0.95 * peak);
  // Sabotage: the way since the last tick in place of a speed, as printed, is six times as long at 1 kHz.
  for (const double dt : {1.0 / 1000.0, 1.0 / 6000.0}) {
    const double way = std::abs(depth(dt) - depth(0.0));
    printed = printed == 0.0 ? way : printed / way;
  }
  CHECK(printed > 5.9);
}

TEST_CASE("drilling force: slow into bone and fast out of it, the hand is given no more than the allowance") {
  const DrillingForceConfig config{};
  const auto depth = [](double t) {  // 10 mm in within a second, out within 0.1 s, at rest between
    const auto eased = [](double share) { return 0.5 - 0.5 * std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0)); };
    const double phase = std::fmod(t, 1.4);
    return 10e-3 * (eased(phase / 1.0) - eased((phase - 1.2) / 0.1));
  };
  for (const double dt : {1e-3, 2e-3, 5e-3, 10e-3, 100e-3}) {
    double work = 0.0, most = 0.0, plain = 0.0, plain_most = 0.0, before = 0.0, speed = 0.0;
    Vec3 held(0.0);
    double plain_held = 0.0;
    move(made(config), dt, 14.0, depth, [&](const Vec3& force, double t) {
      const double z = -depth(t);
      work += held.z * (z - before);
      plain += plain_held * (z - before);
      speed += ((z - before) / dt - speed) * (1.0 - std::exp(-dt / config.time));
      held = force;
      plain_held = config.resistance * std::abs(speed);  // the same without a limit
      before = z;
      most = std::max(most, work);
      plain_most = std::max(plain_most, plain);
    });
    CHECK(most <= config.limit.allowance * (1.0 + 1e-9));
    if (dt < 50e-3)
      CHECK(plain_most > 5.0 * config.limit.allowance);  // at 100 ms the way out is one tick, with the force of the rest before it
  }
}

TEST_CASE("drilling force: what is not finite gives no force, and bad values are refused") {
  DrillingForce law = made({});
  for (int n = 0; n < 20; ++n) (void)law(1e-4 * n * kDown, 1e-4 * n * kDown, kDown, 1e-3);
  CHECK(law(Vec3(NAN, 0.0, 0.0), Vec3(0.0), kDown, 1e-3) == Vec3(0.0));
  CHECK(is_finite(law(Vec3(0.0), Vec3(NAN, 0.0, 0.0), kDown, 1e-3)));
  law.restart();
  CHECK(law(Vec3(1.0, 2.0, 3.0), Vec3(1.0, 2.0, 3.0), kDown, 1e-3) == Vec3(0.0));  // the way to the first position is no motion
  CHECK_FALSE(DrillingForce::create({.resistance = 0.0}).ok());
  CHECK_FALSE(DrillingForce::create({.time = -1.0}).ok());
  CHECK_FALSE(DrillingForce::create({.limit = {.allowance = 0.0}}).ok());
}

}  // namespace
}  // namespace burrhole
