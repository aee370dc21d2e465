#include "haptics/hand/simulated_hand.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/haptics/hand/two_face_bit.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kWall = 6000.0;  // [N/m], a third of the grip's stability limit 2 b / T
const Pose kLevel{};

SimulatedHand make(const HandConfig& config, const Pose& world_from_approach = kLevel) {
  auto hand = SimulatedHand::create(config, world_from_approach, kPeriod);
  REQUIRE(hand.ok());
  return *hand;
}

/// A stiff wall at height 0 of the approach frame that is gone from tick `opens` on.
struct Wall {
  std::uint64_t opens = 0;
  Pose world_from_approach = kLevel;
  [[nodiscard]] Vec3 force(const HandState& state) const {
    const double height = (world_from_approach.inverse() * state.world_from_hand.translation).z;
    const double push = state.tick < opens && height < 0.0 ? -kWall * height : 0.0;
    return world_from_approach.rotate({0.0, 0.0, push});
  }
};

std::vector<HandState> run(SimulatedHand& hand, const Wall& wall, int ticks) {
  std::vector<HandState> states{hand.read()};
  for (int n = 0; n < ticks; ++n) {
    hand.apply({wall.force(states.back()), Vec3(0.0)});
    states.push_back(hand.read());
  }
  return states;
}

/// First tick in that phase; 0 when it never comes.
std::uint64_t first_in(const std::vector<HandState>& states, HandPhase phase) {
  for (const HandState& state : states)
    if (state.phase == phase) return state.tick;
  return 0;
}

constexpr std::uint64_t kOpens = 4000;
constexpr int kTicks = 9000;

}  // namespace

TEST_CASE(
    "SimulatedHand: against a wall that gives way it goes through every phase of the script once, in order, and ends where it began") {
  HandConfig config;
  SimulatedHand hand = make(config);
  const auto states = run(hand, {.opens = kOpens}, kTicks);
  for (std::size_t n = 1; n < states.size(); ++n) {
    REQUIRE(states[n].tick == n);
    REQUIRE(static_cast<int>(states[n].phase) >= static_cast<int>(states[n - 1].phase));
    REQUIRE(static_cast<int>(states[n].phase) <= static_cast<int>(states[n - 1].phase) + 1);
  }
  REQUIRE(states.back().phase == HandPhase::done);
  CHECK(std::abs(states.back().world_from_hand.translation.z - config.standoff) < 0.15 * config.standoff);
  CHECK(std::abs(states.back().thrust) == 0.0);
  // It comes down from the standoff at the feed; to press with the contact force the arm's rest position goes on below the surface by that
  // force over its stiffness. The rest is the arm's lag, b/k = 10 ms, and the wall's give.
  const double contact = static_cast<double>(first_in(states, HandPhase::lean)) * kPeriod;
  const double earliest = config.standoff / config.feed, pressing = config.contact_force / config.dynamics.stiffness / config.feed;
  CHECK(contact > earliest);
  CHECK(contact < earliest + pressing + 0.05);
}

TEST_CASE("SimulatedHand: thrust rises with least jerk to push over the ramp and the wall then carries it, whatever the wall's give") {
  HandConfig config;
  config.tremor_amplitude = 0.0;
  SimulatedHand hand = make(config);
  const Wall wall{.opens = 2 * kOpens};
  const auto states = run(hand, wall, static_cast<int>(kOpens));
  const std::uint64_t lean = first_in(states, HandPhase::lean);
  REQUIRE(lean > 0);
  for (const HandState& state : states) {
    const double since = (static_cast<double>(state.tick) - static_cast<double>(lean)) * kPeriod;
    const double part = std::clamp(since / config.ramp, 0.0, 1.0);
    const double expected = config.push * (10.0 * std::pow(part, 3) - 15.0 * std::pow(part, 4) + 6.0 * std::pow(part, 5));
    // Counted from the same tick, to one tick: the path is steepest half way, 15/8 of its mean.
    REQUIRE(std::abs(state.thrust - expected) < 1.01 * 1.875 * config.push * kPeriod / config.ramp);
  }
  CHECK(states.back().thrust == config.push);
  // The arm's rest position follows the drill with time constant 0.25 s, so that after 2 s and more the spring carries 3e-4 of the thrust.
  CHECK(std::abs(wall.force(states.back()).z - config.push) < 1e-3 * config.push);
}

TEST_CASE("SimulatedHand: releases `reaction` after breakthrough detection, which comes soon after the wall is gone") {
  for (const double reaction : {0.0, 0.15, 0.4}) {
    CAPTURE(reaction);
    HandConfig config;
    config.reaction = reaction;
    SimulatedHand hand = make(config);
    const auto states = run(hand, {.opens = kOpens}, kTicks);
    const std::uint64_t lean = first_in(states, HandPhase::lean), felt = first_in(states, HandPhase::give_felt);
    const std::uint64_t lets_go = first_in(states, HandPhase::release);
    REQUIRE(lets_go > lean);
    if (felt > 0) {
      CHECK(felt >= kOpens);  // not before, while leaning on the wall
      CHECK(felt <= kOpens + 30);
    }
    const auto due = static_cast<std::int64_t>(std::llround(reaction / kPeriod));
    const std::int64_t waited = static_cast<std::int64_t>(lets_go) - static_cast<std::int64_t>(felt > 0 ? felt : lets_go);
    CHECK(std::abs(waited - due) <= 1);  // rounding of a tick
    for (const HandState& state : states)
      if (state.tick >= kOpens && state.tick < lets_go) REQUIRE(state.thrust == config.push);
  }
}

TEST_CASE("SimulatedHand: the release lowers the thrust to zero over `release` and never raises it") {
  for (const double release : {0.0, 0.1, 0.5}) {
    CAPTURE(release);
    HandConfig config;
    config.release = release;
    SimulatedHand hand = make(config);
    const auto states = run(hand, {.opens = kOpens}, kTicks);
    const std::uint64_t lets_go = first_in(states, HandPhase::release), empty = first_in(states, HandPhase::withdraw);
    REQUIRE(lets_go > 0);
    REQUIRE(empty > lets_go);
    CHECK(std::abs(static_cast<double>(empty - lets_go) - release / kPeriod) <= 2.0);
    for (std::size_t n = lets_go + 1; n < states.size(); ++n) {
      REQUIRE(states[n].thrust <= states[n - 1].thrust);
      REQUIRE(states[n].thrust >= 0.0);
      if (states[n].tick > empty) REQUIRE(states[n].thrust == 0.0);
    }
  }
}

TEST_CASE("SimulatedHand: no breakthrough detection and no release while the wall stands") {
  SimulatedHand hand = make({});
  const auto states = run(hand, {.opens = std::numeric_limits<std::uint64_t>::max()}, 20000);
  CHECK(states.back().phase == HandPhase::lean);
  CHECK(first_in(states, HandPhase::give_felt) == 0);
}

// A pore: from one tick on the wall stands three millimetres deeper, so that it carries less than two thirds of the thrust for a moment.
namespace {
struct Pore {
  std::uint64_t opens = kOpens, ends = std::numeric_limits<std::uint64_t>::max();
  double depth = 3e-3;  ///< [m]
};

std::vector<HandState> run_in_pore(const HandConfig& config, const Pore& pore, bool left, int ticks) {
  SimulatedHand hand = make(config);
  std::vector<HandState> states{hand.read()};
  for (int n = 0; n < ticks; ++n) {
    const HandState& state = states.back();
    const double wall = state.tick < pore.opens ? 0.0 : -pore.depth, height = state.world_from_hand.translation.z;
    const double push = state.tick < pore.ends && height < wall ? kWall * (wall - height) : 0.0;
    hand.bone_ahead(left && state.tick < pore.ends);
    hand.apply({{0.0, 0.0, push}, Vec3(0.0)});
    states.push_back(hand.read());
  }
  return states;
}

/// The phases from the first lean on, each as often as it begins.
std::vector<HandPhase> phases_from_lean(const std::vector<HandState>& states) {
  std::vector<HandPhase> out;
  for (const HandState& state : states)
    if (state.phase != HandPhase::approach && (out.empty() || out.back() != state.phase)) out.push_back(state.phase);
  return out;
}
}  // namespace

TEST_CASE("SimulatedHand: after a release in a pore it drills on, where bone is left ahead and carries the falling thrust") {
  using enum HandPhase;
  const std::vector<HandPhase> on{lean, give_felt, release, lean}, back{lean, give_felt, release, withdraw, done};
  const auto phases = [](const HandConfig& config, const Pore& pore, bool left, int ticks = kTicks) {
    return phases_from_lean(run_in_pore(config, pore, left, ticks));
  };
  CHECK(phases({}, {}, true) == on);
  CHECK(phases({}, {}, false) == back);  // the hole is open
  HandConfig stubborn;
  stubborn.resumes = false;
  CHECK(phases(stubborn, {}, true) == back);
  // Nothing carries the thrust: the bit is beside the bone that is left.
  CHECK(phases({}, {.depth = 1.0}, true) == back);
  // What ends at its reach is at its end.
  HandConfig near;
  near.detects = false;
  near.reach = 5e-3;
  CHECK(phases(near, {}, true) == std::vector<HandPhase>{lean, release, withdraw, done});
  // Thrust and detection are those of a first lean.
  const auto states = run_in_pore({}, {.ends = 8000}, true, 14000);
  CHECK(states[7900].thrust == HandConfig().push);
  CHECK(phases_from_lean(states) == std::vector<HandPhase>{lean, give_felt, release, lean, give_felt, release, withdraw, done});
}

TEST_CASE("SimulatedHand: softer bone is no breakthrough at any push, nor is a third of the engagement that a bit loses in pores") {
  for (const double push : kPushes) {
    CAPTURE(push);
    CHECK(drill({.push = push, .soft_from = 2.5, .soft_to = 5.0}, {}).tick == 0);
    CHECK(drill({.push = push, .falls_at = 3.0, .falls = 1.0 / 3.0}, {}).tick == 0);
  }
}

TEST_CASE("SimulatedHand: a bit that loses its engagement is felt within 0.3 mm at any push, though the next face carries the thrust") {
  for (const double push : kPushes) {
    CAPTURE(push);
    // Three quarters: half is the limit.
    for (const double falls : {0.75, 1.0}) {
      const Felt felt = drill({.push = push, .falls_at = 3.0, .falls = falls}, {});
      CHECK(felt.tick > 3000);
      CHECK(felt.tick < 3020);  // a quarter of an oscillation of 0.6 kg on 5 kN/m is 17 ms
      CHECK(felt.advance < 0.3e-3);
    }
    // Sabotage: a hand that expects the whole thrust to be lost.
    CHECK(drill({.push = push, .expects = 1.0, .compliance = 0.0, .falls_at = 3.0}, {}).tick == 0);
  }
}

TEST_CASE("SimulatedHand: a rim that thins gradually is felt by its feed, though no force is missing") {
  for (const double push : kPushes) {
    CAPTURE(push);
    for (const double thins_in : {0.05, 0.5, 2.0}) {
      CAPTURE(thins_in);
      // The feed v = v0 exp(t / T) is four times v0 after T ln 4. Over a window w it is so a little later: the bit has then advanced by
      // T (v - v0) = 3 T v0 and w more at most, and a quarter of w until it is noticed. Then a quarter of an oscillation of the hand and
      // its filter pass, 45 ms, in which T v0 and the advance grow by their e-th power.
      const double starts = 8.0, v0 = 0.4e-3 * push / 28.0, w = std::max(0.15e-3, 0.75 * push / kCut);
      Layers rim{.push = push, .thins_from = starts, .thins_in = thins_in};
      const Felt felt = drill(rim, {}, starts + 4.0 * thins_in);
      const double t = static_cast<double>(felt.tick) * kPeriod - starts;
      REQUIRE(t > 0.0);
      const double advance = thins_in * v0 * (std::exp(t / thins_in) - 1.0);
      CHECK(advance > 3.0 * thins_in * v0);
      CHECK(advance < (4.0 * thins_in * v0 + 1.25 * w) * std::exp(0.045 / thins_in) - thins_in * v0);
      rim.compliance = 0.0;  // sabotage: the missing force alone
      CHECK(drill(rim, {}, starts + std::min(4.0 * thins_in, t)).tick == 0);
    }
  }
}

TEST_CASE("SimulatedHand: the end of all bone is felt within 0.3 mm at any push, also while the thrust rises") {
  for (const double push : kPushes)
    for (const double gone : {1.2, 4.0}) {
      CAPTURE(push);
      CAPTURE(gone);
      const Felt felt = drill({.push = push, .gone_at = gone}, {});
      CHECK(static_cast<double>(felt.tick) * kPeriod > gone);
      CHECK(felt.advance > 0.0);
      CHECK(felt.advance < 0.3e-3);
    }
}

TEST_CASE("SimulatedHand: thrust at once, which rings, is no breakthrough") {
  for (const double ramp : {0.0, 0.02, 0.1}) {
    HandConfig config;
    config.ramp = ramp;
    CHECK(drill({}, config).tick == 0);
    CHECK(drill({.falls_at = 5.0}, config).tick > 5000);
  }
}

TEST_CASE("SimulatedHand: a bit that engages when the drive starts is no breakthrough, unless the hand does not know of it") {
  for (const bool knows : {true, false}) {
    HandConfig config;
    config.exit_drop = kWall / (kWall + 70e3);  // a bit that is engaged by 28 N / 70 kN/m = 0.4 mm
    SimulatedHand hand = make(config);
    bool gave = false;
    for (int n = 0; n < 8000; ++n) {
      const HandState state = hand.read();
      if (n == 5000 && knows) hand.drive_changed();
      const double wall = n < 5000 ? 0.0 : -0.4e-3;
      hand.apply({{0.0, 0.0, std::max(0.0, kWall * (wall - state.world_from_hand.translation.z))}, Vec3(0.0)});
      gave = gave || (state.phase != HandPhase::approach && state.phase != HandPhase::lean);
    }
    CHECK(gave == !knows);
  }
}

TEST_CASE("SimulatedHand: the arm ends at its reach, where thrust is released") {
  HandConfig config;
  config.detects = false;
  config.reach = 0.02;
  SimulatedHand hand = make(config);
  const auto states = run(hand, {.opens = kOpens}, kTicks);
  double deepest = 0.0;
  for (const HandState& state : states) deepest = std::min(deepest, state.world_from_hand.translation.z);
  CHECK(deepest < -0.02);
  CHECK(states.back().phase == HandPhase::done);
}

TEST_CASE("SimulatedHand: with feels = false force changes nothing, so the wall is pushed through") {
  HandConfig config;
  config.feels = false;
  SimulatedHand numb = make(config), alone = make(config);
  const auto against_wall = run(numb, {.opens = kOpens}, 3000), in_air = run(alone, {.opens = 0}, 3000);
  for (std::size_t n = 0; n < in_air.size(); ++n)
    REQUIRE(against_wall[n].world_from_hand.translation == in_air[n].world_from_hand.translation);
  CHECK(against_wall.back().world_from_hand.translation.z < -0.005);
  config.feels = true;
  SimulatedHand feeling = make(config);
  CHECK(run(feeling, {.opens = kOpens}, 3000).back().world_from_hand.translation.z > -0.006);
}

TEST_CASE("SimulatedHand: tremor stays below the amplitude times the arm's largest gain, and settles at the arm's gain at its rate") {
  HandConfig config;
  config.contact_force = 1e9;  // never leans
  config.feed = 0.0;
  SimulatedHand hand = make(config);
  const auto states = run(hand, {.opens = 0}, 6000);
  const double m = config.dynamics.mass, b = config.dynamics.damping, k = config.dynamics.stiffness;
  // Any input of that amplitude stays below amplitude times the integral of the impulse response's magnitude: (1 + q) / (1 - q) with
  // q = exp(-pi zeta / sqrt(1 - zeta^2)) for an under-damped oscillator.
  const double zeta = 0.5 * b / std::sqrt(k * m), q = std::exp(-std::acos(-1.0) * zeta / std::sqrt(1.0 - zeta * zeta));
  const double bound = config.tremor_amplitude * (1.0 + q) / (1.0 - q);
  double largest = 0.0, settled_x = 0.0, settled_y = 0.0;
  for (const HandState& state : states) {
    const Vec3 p = state.world_from_hand.translation;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
    if (state.tick < 3000) continue;
    settled_x = std::max(settled_x, std::abs(p.x));
    settled_y = std::max(settled_y, std::abs(p.y));
  }
  const auto gain = [&](double frequency) {
    const double w = 2.0 * std::acos(-1.0) * frequency;
    return k / std::hypot(k - m * w * w, b * w);
  };
  MESSAGE("tremor at most " << largest * 1e6 << " um, bound " << bound * 1e6 << ", settled " << settled_x * 1e6 << " and "
                            << settled_y * 1e6);
  CHECK(largest < bound);
  // 1 %: the held input lags by half a tick, which changes no amplitude, and peaks are sampled 110 times a period.
  CHECK(std::abs(settled_x / (config.tremor_amplitude * gain(config.tremor_frequency)) - 1.0) < 0.01);
  CHECK(std::abs(settled_y / (config.tremor_amplitude * gain(1.13 * config.tremor_frequency)) - 1.0) < 0.01);
}

TEST_CASE("SimulatedHand: one seed gives the same bits again, another seed another tremor, and no tremor no lateral motion") {
  HandConfig config, other = config, still = config;
  other.seed = 2;
  still.tremor_amplitude = 0.0;
  SimulatedHand a = make(config), b = make(config), c = make(other), d = make(still);
  const Wall wall{.opens = kOpens};
  const auto first = run(a, wall, 5000), again = run(b, wall, 5000), different = run(c, wall, 5000), straight = run(d, wall, 5000);
  double apart = 0.0;
  for (std::size_t n = 0; n < first.size(); ++n) {
    REQUIRE(first[n].world_from_hand.translation == again[n].world_from_hand.translation);
    REQUIRE(first[n].velocity == again[n].velocity);
    REQUIRE(straight[n].world_from_hand.translation.x == 0.0);
    REQUIRE(straight[n].world_from_hand.translation.y == 0.0);
    apart = std::max(apart, glm::length(first[n].world_from_hand.translation - different[n].world_from_hand.translation));
  }
  CHECK(apart > 0.2 * config.tremor_amplitude);
}

TEST_CASE("SimulatedHand: the script runs in the approach frame, a turned and moved one gives the same motion in it") {
  const Pose turned{rotation_from_z(glm::normalize(Vec3(0.4, -0.7, 0.3))), Vec3(0.05, -0.11, 0.2)};
  SimulatedHand level = make({}), oblique = make({}, turned);
  const auto a = run(level, {.opens = kOpens}, 3000), b = run(oblique, {.opens = kOpens, .world_from_approach = turned}, 3000);
  double worst = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    worst = std::max(worst, glm::length(turned.inverse() * b[n].world_from_hand.translation - a[n].world_from_hand.translation));
    REQUIRE(a[n].phase == b[n].phase);
    REQUIRE(b[n].world_from_hand.rotation == turned.rotation);
  }
  // Roundings of positions of 0.2 m, 3e-17 m a tick, through a wall that does not amplify them.
  CHECK(worst < 1e-12);
}

TEST_CASE("SimulatedHand: a drill that stops under the thrust is a breakthrough, once, and only while the hand leans on it and detects") {
  const auto drill = [](HandConfig config, std::uint64_t stops) {
    SimulatedHand hand = make(config);
    const Wall wall{.opens = 100'000};
    std::vector<HandState> states{hand.read()};
    for (std::uint64_t n = 0; n < 9000; ++n) {
      if (n == stops) hand.drill_stopped();
      hand.apply({wall.force(states.back()), Vec3(0.0)});
      states.push_back(hand.read());
    }
    return states;
  };
  HandConfig config;
  const auto stopped = drill(config, 4000);
  const std::uint64_t felt = first_in(stopped, HandPhase::give_felt), lets_go = first_in(stopped, HandPhase::release);
  CHECK(felt == 4001);
  CHECK(std::abs(static_cast<double>(lets_go - felt) - config.reaction / kPeriod) <= 1.0);
  CHECK(stopped.back().phase == HandPhase::done);
  for (const auto& states : {drill(config, 100), drill(config, 100'000)})  // on the way to bone; never
    CHECK(first_in(states, HandPhase::give_felt) == 0);
  config.detects = false;
  CHECK(first_in(drill(config, 4000), HandPhase::give_felt) == 0);
}

TEST_CASE("SimulatedHand: create refuses script values that are negative or not finite, and the body's own") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](const HandConfig& config, double period = kPeriod) {
    const auto hand = SimulatedHand::create(config, kLevel, period);
    return !hand.ok() && hand.error().code == ErrorCode::out_of_range;
  };
  for (double HandConfig::*value : {&HandConfig::feed, &HandConfig::push, &HandConfig::ramp, &HandConfig::reaction, &HandConfig::release,
                                    &HandConfig::contact_force, &HandConfig::exit_drop, &HandConfig::rough_drop, &HandConfig::softest,
                                    &HandConfig::standoff, &HandConfig::tremor_amplitude, &HandConfig::tremor_frequency})
    for (const double bad : {-1e-9, nan, infinity}) {
      HandConfig config;
      config.*value = bad;
      CHECK(refuses(config));
    }
  for (const double bad : {0.0, -0.1, nan}) {
    HandConfig config;
    config.follow_time = bad;
    CHECK(refuses(config));
    CHECK(refuses({}, bad));
    config = {};
    config.dynamics.mass = bad;
    CHECK(refuses(config));
  }
  CHECK_FALSE(refuses({}));
}
