#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/random.h"
#include "haptics/device/device_model.h"
#include "tests/haptics/device/wall_loop.h"

using namespace burrhole;
using test::WallLoop;
using test::WallLoopConfig;

namespace {

/// The oracle's rows: totals of device and hand, delay in ticks; derived twice independently from the exact sampled system.
struct Row {
  MassSpringDamperConfig body;
  double period;    ///< [s]
  int delay;        ///< [ticks]
  double expected;  ///< [N/m]
};
const std::array<Row, 10> kRows{{{{0.10, 0.5, 0.0}, 1e-3, 0, 1001.0},
                                 {{0.10, 2.0, 0.0}, 1e-3, 0, 4013.0},
                                 {{0.10, 5.0, 0.0}, 1e-3, 0, 10084.0},
                                 {{0.10, 5.0, 0.0}, 1e-3, 1, 3379.0},
                                 {{0.10, 5.0, 0.0}, 1e-3, 2, 2042.0},
                                 {{0.05, 5.0, 0.0}, 1e-3, 1, 3423.0},
                                 {{0.25, 5.0, 300.0}, 1e-3, 0, 10034.0},
                                 {{0.25, 5.0, 300.0}, 1e-3, 1, 3353.0},
                                 {{0.10, 5.0, 0.0}, 2e-3, 0, 5085.0},
                                 {{0.10, 5.0, 0.0}, 1e-4, 0, 100083.0}}};

/// A named device in a named hand with all that is not linear taken off.
SimulatedDeviceConfig linear(std::string_view device, std::string_view hand) {
  SimulatedDeviceConfig config = make_simulated_config(*find_device(device).value(), *find_hand(hand).value());
  config.plant.friction = 0.0;
  config.quantum = 0.0;
  config.largest_force = std::numeric_limits<double>::infinity();
  return config;
}

double off(double found, double expected) { return std::abs(found / expected - 1.0); }

}  // namespace

TEST_CASE(
    "servo step and simulated device: the stiffest stable wall is the oracle's within 1 %, late readings or late contact alike, and "
    "another tick misses by more than 10 %") {
  for (const Row& row : kRows) {
    WallLoopConfig config;
    config.period = row.period;
    config.device.plant.body = row.body;
    config.device.delay = row.delay;
    const double found = test::largest_wall(config);
    config.device.delay = row.delay + 1;
    const double sabotaged = test::largest_wall(config);
    MESSAGE("m " << row.body.mass << " b " << row.body.damping << " k_h " << row.body.stiffness << " T " << row.period << " d " << row.delay
                 << ": " << found << " N/m, oracle " << row.expected << ", one more tick " << sabotaged);
    CHECK(off(found, row.expected) < 0.01);
    CHECK(off(sabotaged, row.expected) > 0.1);
    if (row.delay == 0) continue;
    config.device.delay = 0;
    config.contact_delay = row.delay;
    CHECK(off(test::largest_wall(config), row.expected) < 0.01);
  }
}

TEST_CASE("servo step and simulated device: the generic device's limits by name of the hand, within 1 % with its one tick of delay") {
  struct Named {
    const char* hand;
    double expected;
  };
  for (const Named& named : {Named{"none", 334.0}, Named{"nominal", 3353.0}, Named{"light", 668.0}, Named{"firm", 7033.0}}) {
    CAPTURE(std::string(named.hand));
    WallLoopConfig config;
    config.device = linear("generic", named.hand);
    REQUIRE(config.device.delay == 1);
    const double found = test::largest_wall(config);
    config.contact_delay = 1;
    const double sabotaged = test::largest_wall(config);
    MESSAGE("generic device, hand " << std::string(named.hand) << ": " << found << " N/m, oracle " << named.expected << ", one more tick "
                                    << sabotaged);
    CHECK(off(found, named.expected) < 0.01);
    CHECK(off(sabotaged, named.expected) > 0.1);
  }
}

TEST_CASE("servo step and simulated device: the grip feels the world's stiffness times both scales, whatever way the device lies") {
  WallLoopConfig config;
  config.device = linear("generic", "nominal");
  config.map.position_scale = 2.0;
  config.map.force_scale = 0.125;
  config.map.world_from_device = {rotation_from_z({0.48, 0.6, 0.64}), Vec3(0.0)};
  const double found = test::largest_wall(config);
  // A bilateral wall of rank one in a round plant: along its own direction the loop is that of one axis, whatever the axes' names.
  CHECK(off(found * config.map.position_scale * config.map.force_scale, 3353.0) < 0.01);
  config.map.force_scale = 0.25;
  CHECK(off(test::largest_wall(config) * config.map.position_scale * 0.125, 3353.0) > 0.1);
}

namespace {

/// Whether the grip is still moving after a while: a stop with friction is a stop for good, to the bit.
bool keeps_moving(const WallLoopConfig& config, double stiffness, double start, double speed) {
  WallLoop loop(config, stiffness, start, speed);
  for (int n = 0; n < 3000; ++n) loop.tick();
  double low = loop.tick(), high = low;
  for (int n = 0; n < 500; ++n) {
    const double x = loop.tick();
    low = std::min(low, x);
    high = std::max(high, x);
  }
  return high - low > 0.1 * config.device.quantum;
}

/// Starts out of `count` within a few steps of position and a step a tick that end in a limit cycle.
int cycles(const WallLoopConfig& config, double stiffness, int count = 100) {
  int moving = 0;
  const double step = config.device.quantum;
  for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(count); ++n)
    if (keeps_moving(config, stiffness, 4.0 * step * uniform11(1, n), 0.5 * step / config.period * uniform11(2, n))) ++moving;
  return moving;
}

}  // namespace

TEST_CASE(
    "quantised wall: on a light device limit cycles begin a quarter beyond 2 f_c / Delta, none below, and without friction they are there "
    "below") {
  // Light: motion settles within a tick, m / b << T; then a step of position can be crossed from one sample to the next, which is the worst
  // case that the line of Abbott and Okamura guards against. Own derivation for m -> 0: a cycle over one step is there from
  // b / T + f_c / Delta on, the linear limit is 2 b / T; b / T = 1.5 f_c / Delta puts them at 1.25 and 1.5 of the line.
  WallLoopConfig config;
  const double friction = 0.05, step = 0.05e-3, line = 2.0 * friction / step;
  config.device.plant = {{1e-4, 1.5 * friction / step * config.period, 0.0}, friction};
  config.device.quantum = step;
  REQUIRE(line < 2.0 * config.device.plant.body.damping / config.period);  // of the two terms the friction's is the one that binds
  for (const double below : {0.25, 0.5, 0.75, 0.95}) CHECK(cycles(config, below * line) == 0);
  CHECK(cycles(config, 1.4 * line) > 0);
  double first = 1.0;
  while (first < 1.5 && cycles(config, first * line) == 0) first += 0.01;
  MESSAGE("first limit cycle at " << first << " of 2 f_c / Delta, " << cycles(config, 1.4 * line) << " of 100 starts at 1.4");
  CHECK(first > 1.0);
  CHECK(std::abs(first / 1.25 - 1.0) < 0.05);  // the mass is not quite nothing, and a hundred starts do not try every one
  config.device.plant.friction = 0.0;          // sabotage
  CHECK(cycles(config, 0.95 * line) > 0);
}

TEST_CASE(
    "quantised wall: the generic device under its own friction and step is at rest at 0.75 of 2 f_c / Delta, and buzzes there without "
    "friction") {
  const DeviceModel& generic = *find_device("generic").value();
  WallLoopConfig config;
  config.device = make_simulated_config(generic, *find_hand("none").value());
  config.device.delay = 0;
  const double line = 2.0 * generic.friction.value / generic.quantum.value;
  CHECK(line == doctest::Approx(2000.0));
  CHECK(cycles(config, 0.75 * line) == 0);
  double first = 0.75;
  while (first < 20.0 && cycles(config, first * line, 30) == 0) first *= 1.1;
  MESSAGE("generic device without hand, no delay: first limit cycle at about " << first << " of 2 f_c / Delta = " << line << " N/m");
  CHECK(first > 1.0);                  // the line is on the safe side
  CHECK(first < 20.0);                 // and there is an end
  config.device.plant.friction = 0.0;  // sabotage: 1500 N/m is beyond the 1001 of its damping alone
  CHECK(cycles(config, 0.75 * line) > 0);
}
