// Loss of support on thrusts and depths in closed form.

#include "core/measure/support_loss.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace burrhole::test {
namespace {

constexpr double kTick = 1e-3;                 // [s]
constexpr double kFeed = 0.2e-3, kFall = 0.1;  // [m/s]

/// Drives a monitor stretch by stretch at a constant thrust and speed.
struct Drive {
  SupportMonitor monitor;
  double time = 0.0, depth = 0.0;
  bool beyond = false;

  void go(double seconds, double thrust, double speed) {
    for (long n = 0, count = std::lround(seconds / kTick); n < count; ++n) {
      time += kTick;
      depth += speed * kTick;
      monitor.look(time, depth, thrust, beyond);
    }
  }
};

TEST_CASE("loss of support: a bit that leaves the bone cutting at full thrust has none, however far it goes beyond the bone") {
  Drive drive;
  drive.go(2.0, 28.0, kFeed);
  drive.beyond = true;
  drive.go(5.0, 28.0, 3.0 * kFeed);
  CHECK_FALSE(drive.monitor.worst().has_value());
}

TEST_CASE("loss of support: the plunge is the fall from the last supported tick to the deepest point, not what was cut before it") {
  Drive drive;
  drive.go(2.0, 28.0, kFeed);
  drive.beyond = true;
  drive.go(1.0, 28.0, kFeed);
  const double time = drive.time, depth = drive.depth;
  drive.go(0.05, 0.0, kFall);
  drive.go(0.5, 0.0, -kFall);
  REQUIRE(drive.monitor.worst().has_value());
  CHECK(drive.monitor.worst()->time == doctest::Approx(time).epsilon(1e-12));
  CHECK(drive.monitor.worst()->depth == doctest::Approx(depth).epsilon(1e-12));
  CHECK(drive.monitor.worst()->plunge == doctest::Approx(0.05 * kFall).epsilon(1e-9));
}

TEST_CASE("loss of support: it begins at half of the steady thrust, above that there is none") {
  for (const double share : {0.51, 0.49}) {
    CAPTURE(share);
    Drive drive;
    drive.go(5.0, 20.0, kFeed);  // ten time constants: steady to 1e-4
    drive.beyond = true;
    drive.go(kTick, 20.0 * share, kFeed);
    CHECK(drive.monitor.worst().has_value() == (share < kSupportShare));
  }
}

TEST_CASE(
    "loss of support: the steady thrust follows the hand with a time constant of 0.5 s, so a thrust that is lowered slowly is no loss") {
  Drive slow, quick;
  for (Drive* drive : {&slow, &quick}) {
    drive->go(5.0, 20.0, kFeed);
    drive->beyond = true;
  }
  // The mean lags behind a ramp of r by r * 0.5 s: 20 N lowered by 5 N/s is 2.5 N below the mean, above half of it down to 2.5 N.
  double thrust = 20.0;
  for (; thrust > 4.0; thrust -= 5.0 * kTick) slow.go(kTick, thrust, kFeed);
  CHECK_FALSE(slow.monitor.worst().has_value());
  quick.go(kTick, 4.0, kFeed);
  CHECK(quick.monitor.worst().has_value());
  // From 20 N to 9 N at once: 9 N is half of the mean again when the mean is 18 N, after 0.5 s * ln(11 / 9), and 0.1 s later the loss ends.
  Drive step;
  step.go(5.0, 20.0, kFeed);
  step.beyond = true;
  step.go(10.0, 9.0, kFeed);
  const double ends = kSteadyTime * std::log(11.0 / 9.0) + kRegainTime;
  REQUIRE(step.monitor.worst().has_value());
  CHECK(std::abs(step.monitor.worst()->plunge - kFeed * ends) <= 3.0 * kTick * kFeed);
}

TEST_CASE("loss of support: a bounce of less than 0.1 s does not end it, support for 0.1 s does, and the greatest counts") {
  Drive drive;
  drive.go(2.0, 28.0, kFeed);
  drive.beyond = true;
  drive.go(0.02, 0.0, kFall);  // 2 mm
  drive.go(0.09, 28.0, 0.0);   // a bounce
  drive.go(0.03, 0.0, kFall);  // 3 mm more
  CHECK(drive.monitor.worst()->plunge == doctest::Approx(0.05 * kFall).epsilon(1e-9));
  drive.go(1.0, 28.0, kFeed);  // support for good
  const SupportLoss first = *drive.monitor.worst();
  CHECK(std::abs(first.plunge - (0.05 * kFall + kRegainTime * kFeed)) <= 3.0 * kTick * kFeed);
  drive.go(0.04, 0.0, kFall);  // a smaller one
  drive.go(0.2, 28.0, 0.0);
  CHECK(drive.monitor.worst()->time == first.time);
  drive.go(0.06, 0.0, kFall);  // a greater one
  CHECK(drive.monitor.worst()->time > first.time);
  CHECK(drive.monitor.worst()->plunge == doctest::Approx(0.06 * kFall).epsilon(1e-9));
}

TEST_CASE("loss of support: nothing counts before the tip is beyond the bone; a fall that began before counts from where it began") {
  Drive drive;
  drive.go(2.0, 28.0, kFeed);
  drive.go(0.05, 0.0, kFall);  // through a gap inside the bone
  drive.go(0.5, 28.0, kFeed);
  CHECK_FALSE(drive.monitor.worst().has_value());
  const double depth = drive.depth;
  drive.go(0.01, 0.0, kFall);
  drive.beyond = true;
  drive.go(0.02, 0.0, kFall);
  CHECK(drive.monitor.worst()->depth == doctest::Approx(depth).epsilon(1e-12));
  CHECK(drive.monitor.worst()->plunge == doctest::Approx(0.03 * kFall).epsilon(1e-9));
}

TEST_CASE("loss of support: a tool that no bone ever carried loses it where it came out; grown bone takes a loss back") {
  Drive drive;
  drive.go(0.1, 0.0, kFall);
  drive.beyond = true;
  drive.go(kTick, 0.0, kFall);
  const double depth = drive.depth;
  drive.go(0.04, 0.0, kFall);
  CHECK(drive.monitor.worst()->depth == doctest::Approx(depth).epsilon(1e-12));
  CHECK(drive.monitor.worst()->plunge == doctest::Approx(0.04 * kFall).epsilon(1e-9));
  drive.monitor.forget();
  CHECK_FALSE(drive.monitor.worst().has_value());
}

TEST_CASE("loss of support: against a plain twin on random thrusts") {
  // The twin keeps all ticks and finds each loss by its definition.
  struct Tick {
    double time, depth, thrust, steady;
  };
  std::uint64_t state = 12345;  // the seed
  const auto random = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  SupportMonitor monitor;
  std::vector<Tick> ticks;
  double depth = 0.0, thrust = 10.0, mean = 0.0;
  for (int n = 1; n <= 20000; ++n) {
    if (n % 25 == 0) thrust = random() < 0.3 ? 0.0 : 30.0 * random();
    depth += (thrust < 5.0 ? 5e-6 : -1e-6) * random();
    ticks.push_back({n * kTick, depth, thrust, mean});
    if (thrust > kSupportForce) mean = mean == 0.0 ? thrust : thrust + (mean - thrust) * std::exp(-kTick / kSteadyTime);
    monitor.look(n * kTick, depth, thrust, true);
  }
  const auto supported = [](const Tick& t) { return t.thrust > kSupportForce && t.thrust >= kSupportShare * t.steady; };
  SupportLoss worst{0.0, 0.0, -1.0};
  for (std::size_t n = 1; n < ticks.size();) {
    if (supported(ticks[n])) {
      ++n;
      continue;
    }
    SupportLoss loss{ticks[n - 1].time, ticks[n - 1].depth, 0.0};
    std::size_t held = 0;  // supported ticks in a row
    for (; n < ticks.size() && held <= static_cast<std::size_t>(kRegainTime / kTick + 0.5); ++n) {
      loss.plunge = std::max(loss.plunge, ticks[n].depth - loss.depth);
      held = supported(ticks[n]) ? held + 1 : 0;
    }
    if (loss.plunge > worst.plunge) worst = loss;
  }
  REQUIRE(monitor.worst().has_value());
  CHECK(std::abs(monitor.worst()->time - worst.time) < 1.5 * kTick);
  CHECK(std::abs(monitor.worst()->plunge - worst.plunge) < 1e-5);  // two ticks of advance: 0.1 s of ticks is 100 or 101 by rounding
}

}  // namespace
}  // namespace burrhole::test
