#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "haptics/hand/mass_spring_damper.h"
#include "tests/support/stability_search.h"

using namespace burrhole;

// Largest stiffness of a bilateral wall rendered by a sampled, held force: the exact sampled system. Oracle values: derived
// for this project twice independently. m and b are totals of device and hand; K excludes the hand's own spring.

namespace {

struct Loop {
  MassSpringDamperConfig body;
  double period = 1e-3;  ///< [s]
  int delay = 0;         ///< [ticks] between sample and force
};

double growth_at(const Loop& loop, double stiffness) {
  const auto body = MassSpringDamper::create(loop.body, loop.period);
  REQUIRE(body.ok());
  std::array<double, 4> past{};  // positions, newest first
  Vec3 x(1e-3, 0.0, 0.0), v(0.0);
  const auto step = [&] {
    for (std::size_t d = past.size() - 1; d > 0; --d) past[d] = past[d - 1];
    past[0] = x.x;
    body->step(x, v, Vec3(-stiffness * past[static_cast<std::size_t>(loop.delay)], 0.0, 0.0));
    return x.x;
  };
  return test::log_growth(step, 120000);
}

double largest_stiffness(const Loop& loop) {
  return test::largest_stiffness([&](double stiffness) { return growth_at(loop, stiffness); });
}

struct Row {
  Loop loop;
  double expected;  ///< [N/m]
};
const std::array<Row, 10> kRows{{{{{0.10, 0.5, 0.0}, 1e-3, 0}, 1001.0},
                                 {{{0.10, 2.0, 0.0}, 1e-3, 0}, 4013.0},
                                 {{{0.10, 5.0, 0.0}, 1e-3, 0}, 10084.0},
                                 {{{0.10, 5.0, 0.0}, 1e-3, 1}, 3379.0},
                                 {{{0.10, 5.0, 0.0}, 1e-3, 2}, 2042.0},
                                 {{{0.05, 5.0, 0.0}, 1e-3, 1}, 3423.0},
                                 {{{0.25, 5.0, 300.0}, 1e-3, 0}, 10034.0},
                                 {{{0.25, 5.0, 300.0}, 1e-3, 1}, 3353.0},
                                 {{{0.10, 5.0, 0.0}, 2e-3, 0}, 5085.0},
                                 {{{0.10, 5.0, 0.0}, 1e-4, 0}, 100083.0}}};

}  // namespace

TEST_CASE(
    "closed loop: the largest stable stiffness of mass, damper, hold and delay is the oracle's within 1 %, another tick of delay misses") {
  for (const Row& row : kRows) {
    const double found = largest_stiffness(row.loop);
    Loop late = row.loop;
    ++late.delay;
    const double sabotaged = largest_stiffness(late);
    MESSAGE("m " << row.loop.body.mass << " b " << row.loop.body.damping << " k_h " << row.loop.body.stiffness << " T " << row.loop.period
                 << " d " << row.loop.delay << ": K_max " << found << " N/m, oracle " << row.expected << ", one more tick of delay "
                 << sabotaged);
    CHECK(std::abs(found / row.expected - 1.0) < 0.01);
    CHECK(std::abs(sabotaged / row.expected - 1.0) > 0.1);
  }
}

TEST_CASE("closed loop: the passive bound K < b / (T/2 + d T) lies below the limit found, close without a hand's spring") {
  for (const Row& row : kRows) {
    const double passive = row.loop.body.damping / (row.loop.period * (0.5 + row.loop.delay));
    CHECK(passive < row.expected * 1.001);
    CHECK(passive > row.expected * 0.95);
  }
}
