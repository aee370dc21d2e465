#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "app/lab/frontier.h"
#include "app/lab/frontier_search.h"

using namespace burrhole;

// The whole shipped loop (scene, contact, multi-rate, servo, simulated device) on a plate under a preload, against exact sampled systems
// whose limits scripts/frontier_known computes. Bisection stops at 0.5 %; 1 % leaves as much again for the sign of slow growth.

namespace {

double limit_of(const FrontierLoopConfig& config, double hint) {
  const auto loop = FrontierLoop::create(config);
  REQUIRE_MESSAGE(loop.ok(), (loop ? "" : loop.error().text()));
  const auto limit = pressed_limit(*loop, hint, config.servo_hz > 5000 ? 16000 : 8000);
  REQUIRE_MESSAGE(limit.ok(), (limit ? "" : limit.error().text()));
  return *limit;
}

double release_limit_of(const FrontierLoopConfig& config, const Release& start) {
  const auto loop = FrontierLoop::create(config);
  REQUIRE_MESSAGE(loop.ok(), (loop ? "" : loop.error().text()));
  const auto limit = release_limit(*loop, start, 50.0);
  REQUIRE_MESSAGE(limit.ok(), (limit ? "" : limit.error().text()));
  return *limit;
}

/// All figures of a map in its order, as bits.
std::vector<std::uint64_t> bits_of(const std::vector<FrontierRow>& rows) {
  std::vector<std::uint64_t> out;
  for (const FrontierRow& row : rows)
    for (const double value : {row.coupling_damping, row.measured, row.exact, row.known, row.passive, row.quantised, row.linear})
      out.push_back(std::bit_cast<std::uint64_t>(value));
  return out;
}

}  // namespace

TEST_CASE("frontier: every known limit is met through the whole shipped loop within 1 %") {
  REQUIRE(known_limits().size() == 52);
  for (const KnownLimit& known : known_limits()) {
    CAPTURE(std::string(known.name));
    const double found = limit_of(loop_of(known), known.stiffness);
    CAPTURE(found);
    CHECK(std::abs(found / known.stiffness - 1.0) < 0.01);
  }
}

TEST_CASE("frontier: one tick of delay more, a weaker damper or another scheme misses the known limit by far") {
  const KnownLimit& plain = known_limits()[2];
  REQUIRE(plain.stiffness == 10084);
  FrontierLoopConfig late = loop_of(plain);
  late.latency_ticks = 1;
  CHECK(std::abs(limit_of(late, 5000.0) / plain.stiffness - 1.0) > 0.5);
  FrontierLoopConfig weak = loop_of(plain);
  weak.device.plant.body.damping *= 0.9;
  CHECK(std::abs(limit_of(weak, 9000.0) / plain.stiffness - 1.0) > 0.05);
  FrontierLoopConfig drawn = loop_of(plain);
  drawn.contact_ticks = 10;
  drawn.scheme = MultiRateScheme::linear;
  CHECK(std::abs(limit_of(drawn, 1000.0) / 1091.0 - 1.0) > 0.3);  // not the held figure
}

TEST_CASE("frontier: the hint saves runs and does not move the limit") {
  const KnownLimit& plain = known_limits()[2];
  CHECK(std::abs(limit_of(loop_of(plain), 300.0) / plain.stiffness - 1.0) < 0.01);
  CHECK(std::abs(limit_of(loop_of(plain), 2e5) / plain.stiffness - 1.0) < 0.01);
}

// At 20 Hz of contact on curved, unilateral bone, by a device with its friction, steps, delay and cap, in the nominal hand.
TEST_CASE("frontier: at 20 Hz the default scheme keeps three times the stiffness of hold and linear, on a sphere and while drilling") {
  const auto device = find_device("generic");
  const auto hand = find_hand("nominal");
  REQUIRE((device.ok() && hand.ok()));
  for (const bool drilling : {false, true})
    for (const int latency : {0, -1}) {
      FrontierLoopConfig config{.device = make_simulated_config(**device, **hand),
                                .contact_ticks = 50,
                                .latency_ticks = latency,
                                .bone = FrontierBone::sphere,
                                .drilling = drilling};
      const auto limit = [&](MultiRateScheme scheme) {
        config.scheme = scheme;
        return release_limit_of(config, {.pressed = true});
      };
      const double hold = limit(MultiRateScheme::hold), linear = limit(MultiRateScheme::linear), planes = limit(MultiRateScheme::planes);
      MESSAGE(std::string(drilling ? "drilling" : "pressed")
              << ", latency " << latency << ": hold " << hold << ", linear " << linear << ", planes " << planes << " N/m");
      CHECK(planes > 3.0 * std::max(hold, linear));
    }
}

// Four hands at a few dampings, let go over the plate with all limits of the device on. Whoever is free takes the next point.
TEST_CASE("frontier: a map measured by three workers is that of one, in every bit") {
  const auto map = [](unsigned workers) {
    std::size_t told = 0;
    double share = 0.0;
    auto rows = measure_frontier({.thin = true, .part = "released", .workers = workers, .progress = [&](double now) {
                                    ++told;
                                    CHECK(now > share);
                                    share = now;
                                  }});
    REQUIRE(rows.ok());
    CHECK(told == rows->size());
    CHECK(share == 1.0);
    return std::move(rows).value();
  };
  const std::vector<FrontierRow> one = map(1), three = map(3);
  REQUIRE(one.size() >= 8);
  CHECK(bits_of(one) == bits_of(three));
  for (std::size_t n = 0; n < one.size(); ++n) {
    CHECK(one[n].scheme == three[n].scheme);
    CHECK(one[n].start == three[n].start);
    CHECK(one[n].hand == three[n].hand);
  }
  std::vector<FrontierRow> swapped = three;  // sabotage: two rows in each other's place
  std::swap(swapped.front(), swapped.back());
  CHECK(bits_of(one) != bits_of(swapped));
}
