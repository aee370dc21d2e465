#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <thread>

#include "haptics/servo/contact_age.h"
#include "haptics/servo/servo_step.h"
#include "tests/support/local_states.h"

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A hand that is where it is told to be, and keeps the last force.
class ToldHand final : public HandSource {
 public:
  [[nodiscard]] const HandState& read() noexcept override { return state; }
  void apply(const Wrench& on_hand) noexcept override {
    force = on_hand.force;
    if (!hung) ++state.tick;
  }
  HandState state;
  Vec3 force{0.0};
  bool hung = false;
};

struct Bench {
  explicit Bench(const ServoConfig& config) : servo(config, hand, contact, hands) {}
  ToldHand hand;
  TripleBuffer<ContactState> contact;
  TripleBuffer<HandState> hands;
  ServoStep servo;
  std::uint64_t number = 0;
  bool answering = true;  ///< contact evaluates every tick

  double tick(double push = 5.0) {
    if (answering) {
      ContactState state;
      state.on_hand.force = Vec3(0.0, 0.0, push);
      state.world_from_hand = hand.state.world_from_hand;
      state.tick = hand.state.tick;
      state.number = ++number;
      contact.publish(state);
    }
    const ServoOutput& output = servo();
    CHECK(hand.force == output.force);
    return output.force.z;
  }
  void run(int ticks) {
    for (int n = 0; n < ticks; ++n) static_cast<void>(tick());
  }
};

/// Soft start and stop of 10 and 20 ticks.
ServoConfig soft() { return {.period = kPeriod, .largest_force = 50.0, .soft_start = 0.010, .soft_stop = 0.020}; }

/// After reset() the force comes back in ten equal steps.
void check_soft_start(Bench& bench) {
  for (int n = 1; n <= 10; ++n) CHECK(std::abs(bench.tick() - 0.5 * n) < 1e-12);
  CHECK(bench.tick() == 5.0);
}

}  // namespace

TEST_CASE("ServoStep: a fresh config holds the contact's force to the bit, whatever the hand does, without a latched fault") {
  Bench bench{ServoConfig{}};
  for (std::uint64_t n = 0; n < 200; ++n) {
    ContactState state;
    state.on_hand.force = 100.0 * test::random_vector(1, n);  // at most 173 N
    state.number = 1 + n / 10;
    state.local.kind = LocalKind::penalty;
    bench.contact.publish(state);
    bench.hand.state.world_from_hand.translation = test::random_vector(2, n);
    bench.hand.state.velocity = test::random_vector(3, n);
    const ServoOutput& output = bench.servo();
    CHECK(output.force == state.on_hand.force);
    CHECK(output.wanted == state.on_hand.force);
    CHECK(output.faults == 0);
    CHECK(output.gain == 1.0);
    CHECK(output.contact_number == state.number);
  }
}

TEST_CASE("ServoStep: the first force comes through the soft start") {
  Bench bench(soft());
  check_soft_start(bench);
}

TEST_CASE("ServoStep: the largest output is that of the hand, after cap and soft start, and is kept") {
  Bench bench(soft());
  for (int n = 1; n <= 5; ++n) bench.tick();
  CHECK(bench.servo.largest_output() == doctest::Approx(2.5).epsilon(1e-12));  // half of the soft start, of 5 N
  bench.run(20);
  CHECK(bench.servo.largest_output() == doctest::Approx(5.0).epsilon(1e-12));
  bench.tick(80.0);
  CHECK(bench.servo.largest_output() == doctest::Approx(50.0).epsilon(1e-12));  // the cap
  bench.tick(1.0);
  CHECK(bench.servo.largest_output() == doctest::Approx(50.0).epsilon(1e-12));
}

TEST_CASE("ServoStep: a force that is not finite latches zero, is not reset while it lasts, and comes back softly after") {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    Bench bench(soft());
    bench.run(20);
    CHECK(bench.tick(bad) == 0.0);
    CHECK(bench.servo.faults() == kServoForceNotFinite);
    CHECK_FALSE(bench.servo.reset());  // the cause is there
    CHECK(bench.tick() == 0.0);        // gone, but latched
    CHECK(bench.servo.counts().latched == 1);
    CHECK(bench.servo.reset());
    CHECK(bench.servo.faults() == 0);
    check_soft_start(bench);
  }
}

TEST_CASE("ServoStep: planes that are not finite latch zero too, in every scheme that reads them, and leave nothing behind") {
  for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes})
    for (const LocalKind kind : {LocalKind::none, LocalKind::penalty, LocalKind::coupled}) {
      CAPTURE(std::string(name_of(scheme)));
      CAPTURE(static_cast<int>(kind));
      Bench bench({.period = kPeriod, .multi_rate = {.scheme = scheme}, .largest_force = 50.0});
      HoldPlane plane = test::make_plane(Vec3(0.0, 0.0, 1.0), -1e-3, 2e-4, 1);
      plane.force = 5.0;
      ContactState state = kind == LocalKind::coupled ? test::coupled_state({plane}) : test::penalty_state({plane});
      state.local.kind = kind;
      state.number = 1;
      bench.contact.publish(state);
      CHECK(bench.servo().force.z > 0.0);
      ContactState broken = state;
      broken.number = 2;
      for (std::size_t axis = 0; axis < 3; ++axis) broken.force_gradient[axis] = Vec3(kNan);
      broken.local.planes[0].normal = Vec3(kNan);
      broken.local.planes[0].arm = Vec3(kNan);
      bench.contact.publish(broken);
      bench.hand.state.world_from_hand.translation.z = -1e-4;
      CHECK(bench.servo().force == Vec3(0.0));
      state.number = 3;
      bench.contact.publish(state);
      CHECK(bench.servo.reset());
      const Vec3 force = bench.servo().force;
      CHECK(force.z > 0.0);
      CHECK(bench.servo.faults() == 0);
    }
}

TEST_CASE("ServoStep: a hand reading that is not finite latches zero force at once, and contact receives the last finite motion") {
  for (int part = 0; part < 4; ++part) {
    CAPTURE(part);
    Bench bench(soft());
    bench.hand.state.world_from_hand.translation = Vec3(0.1, 0.2, 0.3);
    bench.hand.state.velocity = Vec3(0.01, 0.0, 0.0);
    bench.run(20);
    const HandState good = bench.hand.state;
    if (part == 0) bench.hand.state.world_from_hand.translation.y = kNan;
    if (part == 1) bench.hand.state.velocity.z = std::numeric_limits<double>::infinity();
    if (part == 2) bench.hand.state.world_from_hand.rotation.w = kNan;
    if (part == 3) bench.hand.state.thrust = kNan;
    CHECK(bench.tick() == 0.0);
    CHECK(bench.servo.faults() == kServoHandNotFinite);
    const HandState& told = bench.hands.latest();
    CHECK(told.world_from_hand.translation == good.world_from_hand.translation);
    CHECK(told.velocity == Vec3(0.0));
    CHECK((told.flags & kHandNotFinite) != 0);
    CHECK_FALSE(bench.servo.reset());
    const std::uint64_t tick = bench.hand.state.tick;
    bench.hand.state = good;
    bench.hand.state.tick = tick;
    CHECK(bench.tick() == 0.0);
    CHECK(bench.hands.latest().flags == kHandUnopposed);  // the hand moves freely while the force is latched at zero
    CHECK(bench.servo.reset());
    check_soft_start(bench);
    CHECK(bench.hands.latest().flags == 0);
  }
}

TEST_CASE("ServoStep: a lost device, or one that repeats a tick beyond max_hand_age, latches zero force") {
  for (const bool hangs : {false, true}) {
    ServoConfig config = soft();
    config.max_hand_age = 5;
    Bench bench(config);
    bench.run(20);
    if (hangs) {
      bench.hand.hung = true;
      for (int n = 0; n < 6; ++n) CHECK(bench.tick() == 5.0);  // the reading that began it, and five more of it
    } else {
      bench.hand.state.flags = kHandLost;
    }
    CHECK(bench.tick() == 0.0);
    CHECK(bench.servo.faults() == kServoHandLost);
    CHECK_FALSE(bench.servo.reset());
    bench.hand.hung = false;
    bench.hand.state.flags = 0;
    ++bench.hand.state.tick;
    CHECK(bench.tick() == 0.0);
    CHECK(bench.servo.reset());
    check_soft_start(bench);
  }
  Bench unguarded(soft());  // sabotage: no bound on the age
  unguarded.run(20);
  unguarded.hand.hung = true;
  unguarded.run(100);
  CHECK(unguarded.tick() == 5.0);
}

TEST_CASE("ServoStep: the force fades when contact falls silent, is counted, and comes back softly with it, unlatched") {
  ServoConfig config = soft();
  config.max_contact_age = 10;
  Bench bench(config);
  bench.run(20);
  bench.answering = false;
  for (int age = 1; age <= 10; ++age) {
    CHECK(bench.tick() == 5.0);
    CHECK(bench.servo.faults() == 0);
  }
  for (int n = 1; n <= 20; ++n) {
    CHECK(std::abs(bench.tick() - 5.0 * (1.0 - n / 20.0)) < 1e-12);
    CHECK(bench.servo.faults() == kServoContactStale);
  }
  CHECK(bench.tick() == 0.0);
  CHECK(bench.servo.counts().stale == 21);
  CHECK(bench.servo.counts().latched == 0);
  bench.answering = true;
  check_soft_start(bench);
  CHECK(bench.servo.faults() == 0);
  Bench unguarded(soft());  // sabotage: without the watchdog an old force pushes for ever
  unguarded.run(20);
  unguarded.answering = false;
  unguarded.run(1000);
  CHECK(unguarded.tick() == 5.0);
}

TEST_CASE("ServoStep: an old result that is published again and again is as stale as none") {
  ServoConfig config = soft();
  config.max_contact_age = 10;
  Bench bench(config);
  bench.run(20);
  const ContactState old = bench.contact.latest();
  bench.answering = false;
  for (int n = 0; n < 40; ++n) {
    bench.contact.publish(old);
    static_cast<void>(bench.tick());
  }
  CHECK(bench.tick() == 0.0);
  CHECK(bench.servo.faults() == kServoContactStale);
}

TEST_CASE("ServoStep: a stop asked for from another thread fades the force, which stays away until a reset") {
  Bench bench(soft());
  bench.run(20);
  std::thread([&] { bench.servo.request_stop(); }).join();
  for (int n = 1; n <= 20; ++n) CHECK(std::abs(bench.tick() - 5.0 * (1.0 - n / 20.0)) < 1e-12);
  bench.run(50);
  CHECK(bench.tick() == 0.0);
  CHECK(bench.servo.faults() == kServoStopped);
  bench.servo.request_reset();
  check_soft_start(bench);
  // In one tick a stop outranks a reset, whichever came last: a panel must not undo a signal.
  for (const bool stop_first : {true, false}) {
    bench.servo.request_reset();
    bench.run(20);
    if (stop_first) bench.servo.request_stop();
    bench.servo.request_reset();
    if (!stop_first) bench.servo.request_stop();
    CHECK(bench.tick() < 5.0);
    CHECK(bench.servo.faults() == kServoStopped);
  }
}

TEST_CASE("ServoStep: a wish far beyond the cap winds nothing up, the force is gone in the cap's own ticks") {
  ServoConfig config;
  config.largest_force = 8.0;
  config.largest_slew = 1000.0;  // 1 N a tick
  Bench bench(config);
  for (int n = 0; n < 200; ++n) static_cast<void>(bench.tick(100.0));
  CHECK(bench.tick(100.0) == 8.0);
  for (int n = 1; n <= 8; ++n) CHECK(std::abs(bench.tick(0.0) - (8.0 - n)) < 1e-12);
  // Sabotage: the limits the other way round hold the cap for as long as the way from 100 N down to it takes.
  SlewLimit slew(1.0);
  Vec3 shown(0.0);
  for (int n = 0; n < 200; ++n) shown = shortened(slew({0.0, 0.0, 100.0}), 8.0);
  for (int n = 0; n < 8; ++n) shown = shortened(slew(Vec3(0.0)), 8.0);
  CHECK(shown.z == 8.0);
}

TEST_CASE("ServoStep: a recorded hand state with a replaced non-finite part gives the same force and latched faults") {
  Bench live(soft()), again(soft());
  live.run(20);
  again.run(20);
  live.hand.state.velocity.x = kNan;
  CHECK(live.tick() == 0.0);
  again.hand.state = live.servo.sense();
  CHECK((again.hand.state.flags & kHandNotFinite) != 0);
  CHECK(is_finite(again.hand.state.velocity));
  CHECK(again.tick() == 0.0);
  CHECK(again.servo.faults() == live.servo.faults());
}

TEST_CASE("ServoStep: a reset that is asked for while a cause lasts is forgotten, not kept for later") {
  Bench bench(soft());
  bench.run(20);
  static_cast<void>(bench.tick(kNan));
  bench.servo.request_reset();
  CHECK(bench.tick(kNan) == 0.0);
  bench.run(5);
  CHECK(bench.servo.faults() == kServoForceNotFinite);
  CHECK(bench.hand.force == Vec3(0.0));
}

TEST_CASE(
    "ServoStep: over random forces, stops and silences no change is larger than slew and soft gain allow, and none longer than the cap") {
  for (const bool limited : {true, false}) {
    double worst_change = 0.0, longest = 0.0;
    std::uint32_t seen = 0;
    ServoConfig config = soft();
    config.max_contact_age = 8;
    config.largest_slew = limited ? 2000.0 : 0.0;
    Bench bench(config);
    Vec3 before(0.0);
    for (std::uint64_t n = 0; n < 4000; ++n) {
      if (uniform01(1, n) < 0.02) bench.answering = !bench.answering;
      if (uniform01(2, n) < 0.003) bench.servo.request_stop();
      if (uniform01(3, n) < 0.01) bench.servo.request_reset();
      const bool resets = uniform01(3, n) < 0.01;
      static_cast<void>(bench.tick(120.0 * uniform11(4, n / 7)));
      seen |= bench.servo.faults();
      longest = std::max(longest, glm::length(bench.hand.force));
      if (!resets) worst_change = std::max(worst_change, glm::length(bench.hand.force - before));  // a reset takes all away at once
      before = bench.hand.force;
    }
    // 2 N a tick of slew, and of 50 N the part by which the soft start, the faster of the two gains, changes in a tick.
    const double bound = (2000.0 * kPeriod + 50.0 * kPeriod / 0.010) * (1.0 + 1e-12);
    CHECK(longest <= 50.0 * (1.0 + 1e-15));
    CHECK(seen == (kServoForceCapped | kServoContactStale | kServoStopped | (limited ? kServoSlewLimited : 0u)));
    if (limited)
      CHECK(worst_change <= bound);
    else
      CHECK(worst_change > 5.0 * bound);  // sabotage: slew off
  }
}

TEST_CASE("ServoStep: bone that is touched after a moment in air is felt whole at once, also right after a reset or a stall") {
  ServoConfig config = soft();
  config.max_contact_age = 10;
  for (const bool stalls : {false, true}) {
    Bench bench(config);
    bench.run(20);
    if (stalls) {
      bench.answering = false;
      for (int n = 0; n < 40; ++n) static_cast<void>(bench.tick());
      bench.answering = true;
    } else {
      static_cast<void>(bench.tick(kNan));
      CHECK(bench.tick(0.0) == 0.0);
      CHECK(bench.servo.reset());
    }
    CHECK(bench.tick(0.0) == 0.0);  // nothing is felt, by a contact that saw the hand of now
    CHECK(bench.tick(5.0) == 5.0);
  }
}

TEST_CASE("ServoStep: an old contact that felt nothing does not give the whole force back") {
  Bench bench(soft());
  bench.run(20);
  static_cast<void>(bench.tick(0.0));
  const ContactState old = bench.contact.latest();  // in air, a tick before the reset
  bench.answering = false;
  static_cast<void>(bench.tick());
  CHECK(bench.servo.reset());
  bench.contact.publish(old);
  static_cast<void>(bench.tick());
  bench.answering = true;
  CHECK(bench.tick(5.0) < 5.0 * 0.3);
}

TEST_CASE("ServoStep: a position jump restarts the soft start without a latch") {
  ServoConfig config = soft();
  config.jump_speed = 5.0;  // 5 mm a tick
  Bench bench(config);
  bench.run(20);
  bench.hand.state.world_from_hand.translation.z += 4.9e-3;
  CHECK(bench.tick() == 5.0);
  bench.hand.state.world_from_hand.translation.z += 5.1e-3;
  CHECK(std::abs(bench.tick() - 0.5) < 1e-12);
  CHECK(bench.servo.faults() == kServoHandJumped);
  CHECK(bench.servo.counts().jumped == 1);
  CHECK(bench.servo.counts().latched == 0);
  for (int n = 2; n <= 10; ++n) CHECK(std::abs(bench.tick() - 0.5 * n) < 1e-12);
  CHECK(bench.servo.faults() == 0);
  bench.hand.state.world_from_hand.translation.z += 9.0e-3;  // two ticks went by unread: no jump
  ++bench.hand.state.tick;
  CHECK(bench.tick() == 5.0);
  config.jump_speed = 0.0;  // sabotage: nobody looks
  Bench unguarded(config);
  unguarded.run(20);
  unguarded.hand.state.world_from_hand.translation.z += 20e-3;
  CHECK(unguarded.tick() == 5.0);
}

TEST_CASE("ServoStep: after a restart the old force fades as the new one rises, and a servo fault ends both") {
  Bench bench(soft());
  bench.run(20);
  REQUIRE(bench.tick(5.0) == 5.0);
  bench.servo.restart();
  for (int n = 1; n <= 10; ++n) CHECK(std::abs(bench.tick(8.0) - (5.0 * (10 - n) + 8.0 * n) / 10.0) < 1e-12);
  // Nothing is felt where the bone has gone: the old force fades all the same, and no gain opens beside it.
  bench.servo.restart();
  for (int n = 1; n <= 10; ++n) CHECK(std::abs(bench.tick(0.0) - 8.0 * (10 - n) / 10.0) < 1e-12);
  CHECK(bench.tick(5.0) == 5.0);
  // In free motion there is nothing to fade, and bone that is touched next has its full force.
  CHECK(bench.tick(0.0) == 0.0);
  bench.servo.restart();
  CHECK(bench.tick(0.0) == 0.0);
  CHECK(bench.tick(5.0) == 5.0);
  // A servo fault within the fade leaves nothing of it.
  bench.servo.restart();
  static_cast<void>(bench.tick(0.0));
  bench.hand.state.flags |= kHandLost;
  CHECK(bench.tick(0.0) == 0.0);
  bench.hand.state.flags = 0;
  bench.servo.request_reset();
  CHECK(bench.tick(0.0) == 0.0);
  // Sabotage: without a soft start there is nothing to fade, and the force steps.
  ServoConfig at_once = soft();
  at_once.soft_start = 0.0;
  Bench steps(at_once);
  steps.run(20);
  REQUIRE(steps.tick(5.0) == 5.0);
  steps.servo.restart();
  CHECK(steps.tick(8.0) == 8.0);
}

TEST_CASE("ServoStep: every servo fault has a name of its own, and no other bit has one") {
  std::set<std::string> names;
  for (unsigned bit = 0; bit < 11; ++bit) names.insert(name_of(static_cast<ServoFault>(1u << bit)));
  CHECK(names.size() == 11);
  CHECK(names.count("unknown") == 0);
  CHECK(std::string(name_of(static_cast<ServoFault>(1u << 11))) == "unknown");
}

TEST_CASE("contact_age_limit: three contact periods, at least ten milliseconds") {
  CHECK(contact_age_limit(1, 1e-3) == 10);
  CHECK(contact_age_limit(50, 1e-3) == 150);
  CHECK(contact_age_limit(1, 1.0 / 6000.0) == 60);
  CHECK(contact_age_limit(0, 1e-4) == 100);
}

TEST_CASE("check: a servo config out of range is refused with the name of the value, a fresh one is not") {
  CHECK(check(ServoConfig{}).ok());
  const auto refused = [](const ServoConfig& config, const char* name) {
    const Status status = check(config);
    return !status.ok() && status.error().code == ErrorCode::out_of_range && status.error().message.find(name) != std::string::npos;
  };
  for (const double bad : {-1.0, kNan}) {
    CHECK(refused({.period = bad}, "period"));
    CHECK(refused({.largest_force = bad}, "largest_force"));
    CHECK(refused({.largest_slew = bad}, "largest_slew"));
    CHECK(refused({.soft_start = bad}, "soft_start"));
    CHECK(refused({.soft_stop = bad}, "soft_stop"));
    CHECK(refused({.jump_speed = bad}, "jump_speed"));
    CHECK(refused({.multi_rate = {.max_distance = bad}}, "max_distance"));
    CHECK(refused({.energy = {.damping = bad}}, "energy.damping"));
    CHECK(refused({.energy = {.tolerance = bad}}, "energy.tolerance"));
    CHECK(refused({.energy = {.largest_damping = bad}}, "energy.largest_damping"));
  }
  CHECK(refused({.multi_rate = {.contact_ticks = 0}}, "contact_ticks"));
  CHECK(refused({.period = 0.0}, "period"));
}
