#include "haptics/servo/tool_trail.h"

#include <doctest/doctest.h>

#include <vector>

#include "core/contact/friction.h"
#include "haptics/servo/multi_rate.h"
#include "tests/support/local_states.h"

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;      // [s]
constexpr double kCoupling = 5000.0;  // [N/m]
constexpr double kFast = 5e-3;        // [m/s] of the hand along the floor
constexpr double kDeep = 1e-3;        // [m] of the hand below the floor
constexpr std::uint64_t kEvery = 10;  // servo ticks in a contact period
constexpr double kRounding = 1e-9;    // [N] of a few newtons; the law of friction leaves 1e-12 m, 5e-9 N, in a tick
constexpr double kSlides = 0.1, kSticks = 2.0;

Pose at(const Vec3& position) {
  Pose out;
  out.translation = position;
  return out;
}

ContactState tool_of(std::uint64_t tick, const Pose& tool) {
  ContactState out = test::coupled_state({});
  out.tick = tick;
  out.world_from_tool = tool;
  return out;
}

/// The hand at a tick: pressed on a floor at z = 0 and drawn along it.
HandState drawn(std::uint64_t tick) {
  HandState out;
  out.tick = tick;
  out.world_from_hand.translation = {kFast * kPeriod * static_cast<double>(tick), 0.0, -kDeep};
  out.velocity = {kFast, 0.0, 0.0};
  return out;
}

/// The result of contact for that hand: the tool trails it by what friction holds back on springs without dampers.
ContactState sliding(std::uint64_t tick, std::uint64_t number) {
  const double load = kCoupling * kDeep;
  ContactState out = test::coupled_state({test::make_plane(Vec3(0.0, 0.0, 1.0), 0.0, 1e-12, 1)}, kCoupling);
  out.local.coupling_damping = 0.0;
  const HandState hand = drawn(tick);
  out.tick = tick;
  out.number = number;
  out.world_from_hand = hand.world_from_hand;
  out.world_from_tool = at({hand.world_from_hand.translation.x - kSlides * load / kCoupling, 0.0, 0.0});
  return out;
}

/// [N] force along the floor in each of the ticks 100 to 199, where results of contact come `late` ticks after their hand.
std::vector<double> resistance(std::uint64_t late, double servo_coefficient) {
  auto law = Friction::create({.static_coefficient = servo_coefficient, .kinetic_coefficient = servo_coefficient});
  REQUIRE(law.ok());
  MultiRate rate({.scheme = MultiRateScheme::planes, .contact_ticks = static_cast<int>(kEvery)});
  rate.use_tangential_law(&*law);
  std::vector<double> out;
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    const std::uint64_t newest = tick < late ? 0 : (tick - late) / kEvery * kEvery;
    const double force = -rate(sliding(newest, newest / kEvery + 1), drawn(tick), kPeriod).force.x;
    if (tick >= 100) out.push_back(force);
  }
  return out;
}

}  // namespace

TEST_CASE("ToolTrail: the drift is that from the place of the result's tick, and moves the places since") {
  ToolTrail trail;
  trail.resize(8);
  for (std::uint64_t tick = 0; tick < 12; ++tick) trail.add(tick, at(Vec3(1e-3 * static_cast<double>(tick), 0.0, 0.0)));
  CHECK(!trail.drift(tool_of(3, at({}))));   // forgotten
  CHECK(!trail.drift(tool_of(12, at({}))));  // not there yet
  Pose other = at(Vec3(6e-3, 2e-3, 0.0));
  other.rotation = rotation_of(Vec3(0.0, 0.0, 0.1));
  const auto drift = trail.drift(tool_of(6, other));
  REQUIRE(drift);
  CHECK(glm::length(drift->translation - Vec3(0.0, 2e-3, 0.0)) < 1e-17);
  CHECK(glm::length(drift->turn - Vec3(0.0, 0.0, 0.1)) < 1e-15);
  trail.shift(6, *drift);
  CHECK(glm::length(trail.drift(tool_of(9, at({})))->translation - Vec3(-9e-3, -2e-3, 0.0)) < 1e-17);
  CHECK(glm::length(trail.drift(tool_of(5, at({})))->translation - Vec3(-5e-3, 0.0, 0.0)) < 1e-17);  // the past stays
  CHECK(glm::length(trail.drift(tool_of(6, other))->turn) < 1e-15);
  trail.clear();
  CHECK(!trail.drift(tool_of(9, at({}))));
}

TEST_CASE("MultiRate: with friction the servo's tool goes on from the tool of contact, however late results come") {
  const double load = kCoupling * kDeep, step = kCoupling * kFast * kPeriod;  // [N] friction holds; the springs' change in a tick
  for (const std::uint64_t late : {0, 1, 7, 23}) {
    CAPTURE(late);
    // The same coefficient: as contact has it, in every tick.
    for (const double force : resistance(late, kSlides)) CHECK(std::abs(force - kSlides * load) < kRounding * 10.0);
    // A servo whose friction holds where contact slides: it goes on from contact's force, and never adds to it more than the ticks since. Its
    // own place would have stayed for good, with a force of kSticks times the load or what 200 ticks stretch.
    const std::vector<double> found = resistance(late, kSticks);
    for (std::size_t n = 0; n < found.size(); ++n) {
      const std::uint64_t tick = 100 + n, newest = (tick - late) / kEvery * kEvery;
      const bool measured_now = newest == tick;  // then the tick itself goes on from the result before
      const std::uint64_t since = measured_now ? kEvery : tick - newest;
      CAPTURE(tick);
      CHECK(std::abs(found[n] - (kSlides * load + step * static_cast<double>(since))) < kRounding * 10.0);
    }
  }
}
