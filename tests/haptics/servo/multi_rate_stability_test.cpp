#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "tests/support/servo_loop.h"
#include "tests/support/stability_search.h"

using namespace burrhole;

// Largest stiffness [N/m] of a wall that the shipped servo step renders without growth, contact being looked at every N ticks. Oracle
// values: the exact sampled systems, derived for this project twice independently; the search finds them within its ratio of 0.2 %, well
// below the 1 % asked for. m and b are totals of device and hand; K excludes the hand's own spring.

namespace {

constexpr double kPeriod = 1e-3;                      // [s]
constexpr double kNoLimit = 1e300, kFarGrown = 1e12;  // the cap would turn growth into a limit cycle
constexpr int kTicks = 120000;  // at 1.01 of a limit a factor 10 takes up to 9.2e4 ticks: the sign of the growth shows long before
const MassSpringDamperConfig kDevice{0.1, 5.0, 0.0}, kHeld{0.25, 5.0, 300.0};

struct Scheme {
  MultiRateScheme scheme = MultiRateScheme::hold;
  int contact_ticks = 1;
  int latency = 0;         ///< [ticks]
  bool tick_late = false;  ///< sabotage: every force a servo tick late
  MassSpringDamperConfig body = kDevice;
};

ServoConfig config_of(const Scheme& scheme) {
  return {.period = kPeriod,
          .multi_rate = {.scheme = scheme.scheme,
                         .contact_ticks = scheme.contact_ticks,
                         .max_distance = std::numeric_limits<double>::infinity()},
          .largest_force = kNoLimit};
}

/// Growth of a body let go at 1 (any unit) against the wall; `push` keeps it there against what the wall exerts at 0.
template <class Wall>
double growth(const Scheme& scheme, const Wall& wall, double push, double out_of_bounds) {
  const auto body = MassSpringDamper::create(scheme.body, kPeriod);
  REQUIRE(body.ok());
  test::BodyHand hand(*body, Vec3(1.0, 0.0, 0.0), Vec3(-push, 0.0, 0.0));
  if (scheme.tick_late) hand.be_late();
  test::ServoLoop<Wall> loop(config_of(scheme), hand, wall, scheme.latency);
  const auto step = [&] {
    const double x = loop.tick().hand.world_from_hand.translation.x;
    if (std::abs(x) > out_of_bounds) return std::numeric_limits<double>::infinity();
    return std::abs(x) < 1e-9 ? 0.0 : x;  // less is rounding of the push
  };
  return test::log_growth(step, kTicks);
}

/// A wall that pulls as well as pushes, told as a force only.
double bilateral_limit(const Scheme& scheme, double expected) {
  return test::largest_stiffness(
      [&](double stiffness) {
        const auto wall = [stiffness](const HandState& sampled) {
          ContactState state;
          state.on_hand.force = -stiffness * sampled.world_from_hand.translation;
          return state;
        };
        return growth(scheme, wall, 0.0, kFarGrown);
      },
      0.2 * expected, 5.0 * expected);
}

constexpr double kHeight = 1e3;  // of the surface over the resting place, a thousand swings: contact never opens

/// A plate pressed on by a constant push, told as one plane.
template <class Tell>
double plate_limit(const Scheme& scheme, double expected, const Tell& tell) {
  return test::largest_stiffness(
      [&](double stiffness) {
        const auto wall = [&tell, stiffness](const HandState& sampled) {
          ContactState state;
          const double gap = sampled.world_from_hand.translation.x - kHeight;
          state.on_hand.force = Vec3(std::max(0.0, -stiffness * gap), 0.0, 0.0);
          tell(stiffness, gap, sampled, state);
          return state;
        };
        return growth(scheme, wall, stiffness * kHeight, 0.5 * kHeight);
      },
      0.2 * expected, 5.0 * expected);
}

HoldPlane plane_at(double gap, double yield) {
  HoldPlane plane;
  plane.normal = Vec3(1.0, 0.0, 0.0);
  plane.gap = gap;
  plane.yield = yield;
  plane.point = 7;
  return plane;
}

/// Penalty model: the wall's own give is the plane's.
void tell_penalty(double stiffness, double gap, const HandState& sampled, ContactState& state) {
  state.world_from_tool = sampled.world_from_hand;
  state.force_gradient[0][0] = -stiffness;
  state.local.kind = LocalKind::penalty;
  state.local.count = 1;
  state.local.planes[0] = plane_at(gap, 1.0 / stiffness);
}

/// Held tool on a coupling of that stiffness, bone far stiffer: the tool rests on the surface.
void tell_coupled(double stiffness, double gap, const HandState& sampled, ContactState& state, double damping) {
  state.world_from_tool = sampled.world_from_hand;
  state.world_from_tool.translation.x -= gap;
  state.force_gradient[0][0] = -stiffness;
  state.local.kind = LocalKind::coupled;
  state.local.count = 1;
  state.local.coupling_stiffness = stiffness;
  state.local.coupling_damping = damping;
  state.local.turn_stiffness = 20.0;
  state.local.cutting_stiffness = 1e5;
  state.local.planes[0] = plane_at(0.0, 1e-9 / stiffness);
  state.local.planes[0].force = -stiffness * gap;
}

void check_near(double found, double expected, const char* what) {
  MESSAGE(std::string(what) << ": K_max " << found << " N/m, oracle " << expected);
  CHECK(std::abs(found / expected - 1.0) < 0.01);
}

struct Row {
  int contact_ticks;
  double expected;
};

void check_rows(const Scheme& base, std::initializer_list<Row> rows, bool period_late, const char* what) {
  for (const Row& row : rows) {
    CAPTURE(row.contact_ticks);
    Scheme scheme = base;
    scheme.contact_ticks = row.contact_ticks;
    scheme.latency = period_late ? row.contact_ticks : 0;
    check_near(bilateral_limit(scheme, row.expected), row.expected, what);
  }
}

}  // namespace

TEST_CASE(
    "multi-rate loop: a held force is stable up to the oracle's stiffness within 1 %, alone and in a hand, on time and a period late") {
  check_rows({}, {{2, 5085.0}, {5, 2087.0}, {10, 1091.0}, {20, 598.0}, {50, 322.0}}, false, "held");
  check_rows({.body = kHeld}, {{10, 1045.0}, {20, 558.0}, {33, 382.0}, {50, 314.0}}, false, "held, in a hand");
  check_rows({}, {{2, 1712.0}, {5, 710.0}, {10, 373.0}, {20, 201.0}}, true, "held, a slow tick late");
}

TEST_CASE(
    "multi-rate loop: a linearly drawn force is stable up to the oracle's stiffness within 1 %, alone and in a hand, on time and late") {
  const MultiRateScheme linear = MultiRateScheme::linear;
  check_rows({.scheme = linear}, {{2, 3407.0}, {5, 1175.0}, {10, 585.0}, {20, 309.0}, {50, 141.0}}, false, "linear");
  check_rows({.scheme = linear, .body = kHeld}, {{10, 566.0}, {20, 311.0}, {33, 231.0}, {50, 216.0}}, false, "linear, in a hand");
  check_rows({.scheme = linear}, {{2, 1475.0}, {5, 569.0}, {10, 295.0}, {20, 158.0}}, true, "linear, a slow tick late");
}

TEST_CASE("multi-rate loop: weights a tick behind, i / N, give the other oracle's figures and miss the ones of (i + 1) / N") {
  // A force that comes one servo tick late is the line with weight i / N.
  const Scheme sabotaged{.scheme = MultiRateScheme::linear, .tick_late = true};
  check_rows(sabotaged, {{2, 2052.0}, {5, 965.0}, {10, 531.0}, {20, 294.0}}, false, "linear, weight i / N");
  Scheme ten = sabotaged;
  ten.contact_ticks = 10;
  CHECK(std::abs(bilateral_limit(ten, 585.0) / 585.0 - 1.0) > 0.05);
}

TEST_CASE("multi-rate loop: virtual damping by backward difference raises the limit to the oracle's figures within 1 %") {
  const MassSpringDamperConfig body{0.1, 1.0, 0.0};
  const auto limit = [&](double damping, double expected) {
    return test::largest_stiffness(
        [&](double stiffness) {
          const auto wall = [stiffness, damping, before = 1.0](const HandState& sampled) mutable {
            ContactState state;
            const double x = sampled.world_from_hand.translation.x;
            state.on_hand.force.x = -stiffness * x - damping * (x - before) / kPeriod;
            before = x;
            return state;
          };
          return growth({.body = body}, wall, 0.0, kFarGrown);
        },
        0.2 * expected, 5.0 * expected);
  };
  const std::array<std::array<double, 2>, 6> rows{
      {{0.0, 2003.0}, {1.0, 3967.0}, {2.0, 5892.0}, {5.0, 11437.0}, {10.0, 19948.0}, {20.0, 34457.0}}};
  for (const auto& [damping, expected] : rows) check_near(limit(damping, expected), expected, "damped wall");
  CHECK(std::abs(limit(10.0, 34457.0) / 34457.0 - 1.0) > 0.3);  // half the damping is another figure
}

TEST_CASE(
    "multi-rate loop: gradient and planes on one plate reach the servo-rate limit at any contact rate, a frozen gradient of half does "
    "not") {
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    for (const int contact_ticks : {1, 10, 50}) {
      CAPTURE(std::string(name_of(scheme)));
      CAPTURE(contact_ticks);
      const Scheme alone{.scheme = scheme, .contact_ticks = contact_ticks};
      const Scheme in_hand{.scheme = scheme, .contact_ticks = contact_ticks, .body = kHeld};
      check_near(plate_limit(alone, 10084.0, tell_penalty), 10084.0, "penalty plate");
      check_near(plate_limit(in_hand, 10034.0, tell_penalty), 10034.0, "penalty plate, in a hand");
    }
  const auto half = [](double stiffness, double gap, const HandState& sampled, ContactState& state) {
    tell_penalty(stiffness, gap, sampled, state);
    state.local.planes[0].yield *= 2.0;
    state.local.planes[0].gap *= 2.0;
  };
  const Scheme ten{.scheme = MultiRateScheme::gradient, .contact_ticks = 10};
  CHECK(plate_limit(ten, 10084.0, half) < 0.5 * 10084.0);
}

TEST_CASE("multi-rate loop: the gradient alone, where no planes are listed, reaches the servo-rate limit too") {
  const auto gradient_only = [](double stiffness, double gap, const HandState& sampled, ContactState& state) {
    tell_penalty(stiffness, gap, sampled, state);
    state.local.kind = LocalKind::none;
    state.local.count = 0;
  };
  check_near(plate_limit({.scheme = MultiRateScheme::gradient, .contact_ticks = 10}, 10084.0, gradient_only), 10084.0, "gradient only");
}

TEST_CASE(
    "multi-rate loop: a constrained tool on its coupling reaches the servo-rate limit, and with the coupling's damper that of a true "
    "speed") {
  const auto undamped = [](double stiffness, double gap, const HandState& sampled, ContactState& state) {
    tell_coupled(stiffness, gap, sampled, state, 0.0);
  };
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    check_near(plate_limit({.scheme = scheme, .contact_ticks = 10}, 10084.0, undamped), 10084.0, "held tool");
  // Held by a plane that does not give, the damper takes the hand's own speed: the oracle's wall with true v.
  const auto damped = [](double stiffness, double gap, const HandState& sampled, ContactState& state) {
    tell_coupled(stiffness, gap, sampled, state, 20.0);
  };
  const Scheme planes{.scheme = MultiRateScheme::planes, .contact_ticks = 10, .body = {0.1, 1.0, 0.0}};
  check_near(plate_limit(planes, 42070.0, damped), 42070.0, "held tool with damper");
  Scheme late = planes;
  late.tick_late = true;
  CHECK(std::abs(plate_limit(late, 42070.0, damped) / 42070.0 - 1.0) > 0.3);
}
