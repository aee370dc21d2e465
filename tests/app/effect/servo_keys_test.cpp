// [servo] in a run: each number limits, delays or damps the force on a hand that is moved as given, by a stated amount.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "tests/app/effect/pressed_plate.h"

namespace burrhole::test {
namespace {

constexpr double kCoupling = 5000.0, kTick = 1e-3;  // [N/m], [s]
// [N] Contact of a ball with a plate is found to 0.03 of a voxel of 0.25 mm (constrained_tool.h).
constexpr double kContact = 0.04;

/// In the air for 0.1 s, then at once `depth` [m] down.
std::function<double(std::size_t)> step_to(double depth) {
  return [depth](std::size_t tick) { return tick < 100 ? -0.1e-3 : depth; };
}

}  // namespace

TEST_CASE("servo: force_N is the largest force on the hand, whatever bone does") {
  // 4 mm deep, slowly: 20 N.
  const auto depth = [](std::size_t tick) { return 1e-5 * std::min(400.0, static_cast<double>(tick)); };
  for (const double largest : {8.0, 12.0}) {
    const std::vector<double> found = sent({"hand.push_N=5", fmt::format("servo.force_N={}", largest)}, depth);
    CHECK(std::ranges::max(found) == doctest::Approx(largest).epsilon(1e-12).scale(0.0));
    // It is reached where the spring has it.
    const auto first = std::ranges::find_if(found, [&](double force) { return force > largest * (1.0 - 1e-9); });
    CHECK(std::abs(static_cast<double>(first - found.begin()) - largest / kCoupling / 1e-5) <= kContact / kCoupling / 1e-5 + 1.0);
  }
  CHECK(std::abs(std::ranges::max(sent({"hand.push_N=5"}, depth)) - 20.0) < kContact);
}

TEST_CASE("servo: slew_N_per_s is the change of the force in a tick over its time") {
  for (const double slew : {500.0, 550.0, 2000.0}) {
    const std::vector<double> found = sent({fmt::format("servo.slew_N_per_s={}", slew)}, step_to(2e-3));
    CHECK(found[99] == 0.0);
    CHECK(std::abs(found.back() - kCoupling * 2e-3) < kContact);
    const auto ticks = static_cast<std::size_t>((10.0 - kContact) / slew / kTick);
    for (std::size_t n = 0; n < ticks; ++n) CHECK(std::abs(found[100 + n] - static_cast<double>(n + 1) * slew * kTick) < 1e-9);
    CHECK(found[100 + ticks + 1] == doctest::Approx(found.back()).epsilon(1e-9).scale(0.0));
  }
  CHECK(std::abs(sent({}, step_to(2e-3))[100] - kCoupling * 2e-3) < kContact);  // without it at once
}

TEST_CASE("servo: jump_m_per_s is the speed from which a motion is a jump, and soft_start_s the time in which its force returns") {
  // 2.1 mm in a tick are 2.1 m/s.
  CHECK(std::abs(sent({"servo.jump_m_per_s=2.2"}, step_to(2e-3))[100] - kCoupling * 2e-3) < kContact);
  for (const double time : {0.1, 0.11, 0.25}) {
    const std::vector<double> found = sent({"servo.jump_m_per_s=2.0", fmt::format("servo.soft_start_s={}", time)}, step_to(2e-3));
    CHECK(std::abs(found.back() - kCoupling * 2e-3) < kContact);
    for (std::size_t n = 100; n < 600; ++n) {
      const double gain = std::min(1.0, static_cast<double>(n - 99) * kTick / time);
      REQUIRE(std::abs(found[n] - gain * found.back()) < 1e-9);
    }
  }
}

TEST_CASE("servo: soft_stop_s is the time in which the force falls after a stop") {
  for (const double time : {0.05, 0.055, 0.2}) {
    const std::vector<double> found = sent({fmt::format("servo.soft_stop_s={}", time)}, step_to(2e-3), 300);
    for (std::size_t n = 300; n < 600; ++n) {
      const double gain = std::max(0.0, 1.0 - static_cast<double>(n - 299) * kTick / time);
      REQUIRE(std::abs(found[n] - gain * found[299]) < 1e-9);
    }
    CHECK(std::abs(found[299] - kCoupling * 2e-3) < kContact);
  }
}

TEST_CASE("servo: between contact results the force grows until the hand has moved by reach_mm") {
  // Down by 20 mm/s with a contact result each 50 ms, 1 mm: the force grows by stiffness times way, at most times the reach.
  for (const std::string scheme : {"planes", "gradient"})
    for (const double reach : {0.3, 0.33, 0.7, 2.0}) {
      CAPTURE(scheme);
      CAPTURE(reach);
      const std::vector<double> found =
          sent({"contact.rate_hz=20", "servo.multirate=\"" + scheme + "\"", fmt::format("servo.reach_mm={}", reach), "servo.force_N=1000"},
               [](std::size_t tick) { return -0.1e-3 + 2e-5 * static_cast<double>(tick); });
      for (std::size_t n = 100; n < 600; ++n) {
        const double way = 2e-2 * static_cast<double>(n % 50);
        REQUIRE(std::abs(found[n] - found[n - n % 50] - kCoupling * 1e-3 * std::min(way, reach)) < kContact);
      }
    }
}

TEST_CASE("servo: multirate says what the force is between contact results: held, or a line to the last, one period late") {
  const auto with = [](const std::string& scheme) {
    return sent({"contact.rate_hz=20", "servo.multirate=\"" + scheme + "\""},
                [](std::size_t tick) { return -0.1e-3 + 5e-6 * static_cast<double>(tick); });
  };
  const std::vector<double> held = with("hold"), line = with("linear");
  for (std::size_t n = 100; n < 600; ++n) {
    REQUIRE(std::abs(held[n] - kCoupling * (5e-6 * static_cast<double>(n - n % 50) - 0.1e-3)) < kContact);
    REQUIRE(std::abs(line[n] - (held[n - 50] + (held[n] - held[n - 50]) * static_cast<double>(n % 50 + 1) / 50.0)) < 1e-9);
  }
}

namespace {

/// A hand that goes to and fro in bone, which answers late: it gets more than it gives.
double swinging(std::size_t tick) { return 0.5e-3 * (1.0 - std::cos(0.02 * static_cast<double>(tick))); }

/// [J] what the wall has received, and what is relied on, at each tick that the hand gets these forces. Without force there is no credit.
std::vector<double> balance(const std::vector<double>& forces, double relied_on) {
  std::vector<double> out{0.0};
  const auto velocity = [](std::size_t n) { return (swinging(n - 1) - swinging(n)) / kTick; };
  double energy = 0.0;
  for (std::size_t n = 1; n < forces.size(); ++n) {
    const double before = n == 1 ? 0.0 : velocity(n - 1), now = velocity(n);
    if (forces[n - 1] == 0.0) energy = std::min(energy, 0.0);
    energy += relied_on * (before * before + before * now + now * now) / 3.0 * kTick - forces[n - 1] * now * kTick;
    out.push_back(energy);
  }
  return out;
}
std::vector<std::string> late(std::vector<std::string> more = {}) {
  more.insert(more.end(), {"servo.multirate=\"hold\"", "contact.rate_hz=100", "contact.latency_ticks=20", "servo.soft_start_s=0"});
  return more;
}

}  // namespace

TEST_CASE(
    "servo: energy_mJ is the deficit at which the force is latched to zero, relied_on_N_s_per_m the damping that is counted against it") {
  const std::vector<double> open = sent(late(), swinging);
  std::set<std::ptrdiff_t> ticks;
  for (const auto& [tolerance, relied_on] : {std::pair{1.0, 0.0}, {1.1, 0.0}, {2.0, 0.0}, {1.0, 50.0}, {1.0, 55.0}}) {
    CAPTURE(tolerance);
    CAPTURE(relied_on);
    const std::vector<double> found =
        sent(late({fmt::format("servo.energy_mJ={}", tolerance), fmt::format("servo.relied_on_N_s_per_m={}", relied_on)}), swinging);
    const std::vector<double> energy = balance(open, relied_on);
    const auto latched = std::ranges::find_if(energy, [&](double now) { return now < -tolerance * 1e-3; }) - energy.begin();
    MESSAGE("latched at tick " << latched);
    REQUIRE(latched < 600);
    ticks.insert(latched);
    for (std::size_t n = 0; n < 600; ++n) REQUIRE(found[n] == (n < static_cast<std::size_t>(latched) ? open[n] : 0.0));
  }
  CHECK(ticks.size() == 5);  // a tenth more of a key is seen
}

TEST_CASE("servo: passivity_N_s_per_m is the largest damping that a deficit adds") {
  const std::vector<double> open = sent(late(), swinging);
  for (const double most : {10.0, 11.0, 1e4}) {
    CAPTURE(most);
    const std::vector<double> found = sent(late({fmt::format("servo.passivity_N_s_per_m={}", most)}), swinging);
    const std::vector<double> energy = balance(found, 0.0);
    double worst = 0.0;
    int capped = 0, whole = 0;
    for (std::size_t n = 1; n < 600; ++n) {
      const double velocity = (swinging(n - 1) - swinging(n)) / kTick, needed = -energy[n] / (kTick * velocity * velocity);
      const double added = energy[n] < 0.0 ? -velocity * std::min(most, needed) : 0.0;
      capped += energy[n] < 0.0 && needed > most ? 1 : 0;
      whole += energy[n] < 0.0 && needed < most ? 1 : 0;
      worst = std::max(worst, std::abs(found[n] - open[n] - added));
    }
    MESSAGE("within " << worst << " N, " << capped << " ticks at the limit, " << whole << " below it");
    CHECK(worst < 1e-9);
    CHECK((most < 100.0 ? capped : whole) > 50);
  }
}

}  // namespace burrhole::test
