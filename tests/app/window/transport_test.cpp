#include "app/window/transport.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kTick = 1e-3;

/// A replay that computes `most` ticks a call. @returns the ticks computed by a restart and after it.
int compute(Transport& transport, double& time, int most) {
  int done = 0;
  if (transport.is_behind()) {
    time = 0.0;
    transport.arrive(time);
  }
  while (done < most && !transport.has_arrived()) {
    time += kTick;
    transport.arrive(time);
    ++done;
  }
  return done;
}

TEST_CASE("a fast replay shows the session at the speed asked for") {
  for (const double speed : {0.0625, 0.5, 1.0, 4.0, 16.0}) {
    CAPTURE(speed);
    Transport transport(100.0, kTick);
    transport.set_speed(speed);
    double time = 0.0;
    for (int n = 0; n < 400; ++n) {
      transport.advance(0.005);
      (void)compute(transport, time, 1'000'000);
    }
    CHECK(time == doctest::Approx(2.0 * speed).epsilon(1e-9).scale(1.0));
    CHECK(std::abs(time - 2.0 * speed) <= kTick);  // it computes whole ticks
    CHECK_FALSE(transport.seeks());
  }
}

TEST_CASE("a slow replay is not left behind, and does not hurry afterwards") {
  Transport transport(100.0, kTick);
  transport.set_speed(16.0);
  double time = 0.0;
  for (int n = 0; n < 200; ++n) {
    transport.advance(0.005);            // 80 ms asked for,
    (void)compute(transport, time, 10);  // 10 ms computed
    CHECK(transport.head() - transport.arrived() <= 1.6 + kTick);
  }
  CHECK(time == doctest::Approx(2.0));
}

TEST_CASE("a jump back begins again, a jump ahead does not; both are shown at their end only") {
  Transport transport(10.0, kTick);
  double time = 0.0;
  transport.jump(5.0);
  CHECK(transport.seeks());
  CHECK_FALSE(transport.is_behind());
  transport.advance(1.0);
  CHECK(transport.head() == 5.0);  // waits for the replay
  CHECK(compute(transport, time, 1000) == 1000);
  CHECK(transport.seeks());
  CHECK(compute(transport, time, 1'000'000) == 4000);
  CHECK_FALSE(transport.seeks());
  transport.jump(2.0);
  CHECK(transport.is_behind());
  CHECK(transport.seeks());
  CHECK(compute(transport, time, 1'000'000) == 2000);
  CHECK_FALSE(transport.seeks());
  CHECK(time == doctest::Approx(2.0));
}

TEST_CASE("steps pause, and go both ways") {
  Transport transport(1.0, kTick);
  double time = 0.0;
  transport.step(kTick);
  CHECK_FALSE(transport.runs());
  CHECK(compute(transport, time, 100) == 1);
  transport.advance(1.0);
  CHECK(compute(transport, time, 100) == 0);
  transport.step(-kTick);
  CHECK(transport.is_behind());
  CHECK(compute(transport, time, 100) == 0);
  CHECK(time == 0.0);
  transport.step(-kTick);  // before the start there is nothing
  CHECK(transport.head() == 0.0);
  CHECK_FALSE(transport.is_behind());
}

TEST_CASE("at the end it stops; running begins again") {
  Transport transport(0.05, kTick);
  double time = 0.0;
  for (int n = 0; n < 100; ++n) {
    transport.advance(0.005);
    (void)compute(transport, time, 1000);
  }
  CHECK(transport.head() == 0.05);
  CHECK_FALSE(transport.runs());
  transport.run(true);
  CHECK(transport.is_behind());
  CHECK(transport.head() == 0.0);
}

TEST_CASE("a session that ends before its record ends there: the head waits, and a jump beyond comes to its end") {
  Transport transport(2.0, kTick);
  double time = 0.0;
  transport.jump(1.9);
  transport.arrive(1.5);
  transport.end_at(1.5);
  CHECK(transport.head() == 1.5);
  CHECK(transport.has_arrived());
  CHECK_FALSE(transport.seeks());
  transport.advance(10.0);
  CHECK_FALSE(transport.runs());
  transport.jump(5.0);
  CHECK(transport.head() == 1.5);
  CHECK_FALSE(transport.is_behind());
  transport.jump(0.5);
  CHECK(transport.is_behind());
  (void)compute(transport, time, 1000);
  CHECK(time == doctest::Approx(0.5));
}

TEST_CASE("values out of range are kept in range") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Transport transport(2.0, kTick);
  double time = 0.0;
  std::uint64_t count = 0;
  for (const double bad : {nan, inf, -inf, 1e300, -1e300, 0.0, -1.0}) {
    transport.jump(bad);
    transport.set_speed(bad);
    transport.advance(bad);
    (void)compute(transport, time, static_cast<int>(mix64(++count) % 3000));
    CHECK(transport.head() >= 0.0);
    CHECK(transport.head() <= 2.0);
    CHECK(transport.speed() >= Transport::kSlowest);
    CHECK(transport.speed() <= Transport::kFastest);
  }
}

}  // namespace
}  // namespace burrhole
