#include "haptics/hand/feed_hand.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;  // [s]
const Pose kTurned{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};

FeedHand make(const FeedHandConfig& config, const Pose& world_from_approach = {}) {
  auto hand = FeedHand::create(config, world_from_approach, kPeriod);
  REQUIRE(hand.ok());
  return *hand;
}

struct Tick {
  double height, climb;  ///< [m], [m/s] in the approach frame
  HandState state;
};

/// Runs until done. @param force [N] along the axis on a carriage at that height, for each tick.
std::vector<Tick> run(FeedHand hand, const std::function<double(double)>& force, const Pose& world_from_approach = {}) {
  std::vector<Tick> out;
  const Pose approach_from_world = world_from_approach.inverse();
  for (int n = 0; n < 60000; ++n) {
    const HandState state = hand.read();
    const double height = (approach_from_world * state.world_from_hand.translation).z;
    out.push_back({height, (glm::conjugate(world_from_approach.rotation) * state.velocity).z, state});
    if (state.phase == HandPhase::done) return out;
    hand.apply({world_from_approach.rotate({3.0, -2.0, force(height)}), Vec3(0.0)});
  }
  return out;
}

double deepest(const std::vector<Tick>& ticks) { return -std::ranges::min_element(ticks, {}, &Tick::height)->height; }

/// Bone behind a coupling K: the drill stands on a face that recedes at `rate` [m/s/N] times the force, and is gone below `thickness`.
struct Bone {
  double coupling = 5000.0;  ///< [N/m]
  double rate = 2e-5;
  double thickness = 1.0;  ///< [m]
  double face = 0.0;       ///< [m]
  double force = 0.0;      ///< [N]
  double operator()(double height) {
    force = face > -thickness ? std::max(0.0, coupling * (face - height)) : 0.0;
    face -= rate * force * kPeriod;
    return force;
  }
};

}  // namespace

TEST_CASE("FeedHand: in air depth is feed times time, the stop is met within one tick's travel and never passed") {
  for (const double feed : {0.0005, 0.00037, 0.02}) {
    CAPTURE(feed);
    const FeedHandConfig config{.feed = feed};
    const auto ticks = run(
        make(config, kTurned), [](double) { return 0.0; }, kTurned);
    REQUIRE(ticks.back().state.phase == HandPhase::done);
    const double length = config.standoff + config.stop;
    for (std::size_t n = 0; n < ticks.size(); ++n) {
      const double travelled = feed * static_cast<double>(n) * kPeriod;
      // Roundings of 1e-17 m a tick and of places of 0.2 m.
      if (travelled < length - feed * kPeriod) REQUIRE(std::abs(config.standoff - ticks[n].height - travelled) < 1e-12);
      REQUIRE(ticks[n].state.tick == n);
      REQUIRE(ticks[n].height > -config.stop - 1e-15);
    }
    const auto turns = std::ranges::find(ticks, HandPhase::withdraw, [](const Tick& t) { return t.state.phase; });
    const double due = length / feed / kPeriod;
    CHECK(std::abs(static_cast<double>(turns - ticks.begin()) - due) <= 1.0);
    CHECK(std::abs(turns->height + config.stop) < 1e-15);
    CHECK(std::abs(static_cast<double>(ticks.end() - turns) - 0.5 * due) <= 2.0);  // twice as fast, from the stop to the standoff
    CHECK(ticks.back().height == doctest::Approx(config.standoff));
  }
}

TEST_CASE("FeedHand: a fixed feed does not depend on the force, which is reported as the thrust") {
  const FeedHandConfig config{.feed = 0.002};
  const auto in_air = run(make(config), [](double) { return 0.0; });
  const auto in_wall = run(make(config), [](double height) { return std::max(0.0, -1e5 * height); });
  REQUIRE(in_air.size() == in_wall.size());
  double most = 0.0;
  for (std::size_t n = 0; n < in_air.size(); ++n) {
    REQUIRE(in_air[n].height == in_wall[n].height);
    most = std::max(most, in_wall[n].state.thrust);
  }
  CHECK(std::abs(most - 1e5 * config.stop) < 1e5 * config.feed * kPeriod * 1.01);
}

TEST_CASE("FeedHand: a coupling that gives is added to the carriage's way, so that the tip is at the stop") {
  for (const bool with_thrust : {false, true}) {
    CAPTURE(with_thrust);
    FeedHandConfig config{.feed = 0.0005, .stop = 0.002, .compliance = 1.0 / 5000.0};
    if (with_thrust) config.push = 20.0;
    Bone bone;
    const auto ticks = run(make(config), std::ref(bone));
    REQUIRE(ticks.back().state.phase == HandPhase::done);
    // The tip passes the stop by what the face recedes while the coupling is unloaded at 1 m/s: 20 N are 4 mm, in 4 ms.
    // By feed v the coupling K on a face that recedes at r F is stretched by x = v / (K r) (1 - exp(-K r t)), and the face at v t - x reaches the
    // stop long before x has come to the end, 5 mm in 10 s.
    double force = 20.0;
    if (!with_thrust) {
      const double settle = 1.0 / (bone.coupling * bone.rate);  // [s]
      const auto stretched = [&](double t) { return config.feed * settle * (1.0 - std::exp(-t / settle)); };
      double early = 0.0, late = 100.0;
      for (int n = 0; n < 60; ++n) {
        const double t = 0.5 * (early + late);
        (config.feed * t - stretched(t) < config.stop ? early : late) = t;
      }
      force = bone.coupling * stretched(late);
    }
    CHECK(-bone.face >= config.stop - 1e-12);
    CHECK(-bone.face < config.stop + 0.01e-3);
    CHECK(std::abs(deepest(ticks) - config.stop - force / bone.coupling) < 0.01e-3);
    // Sabotage: a carriage that takes the tip to be where it is itself stops before the tip is there.
    config.compliance = 0.0;
    Bone same;
    run(make(config), std::ref(same));
    CHECK(-same.face < 0.5 * config.stop);
  }
}

TEST_CASE("FeedHand: a force that is low for milliseconds, as a damper makes it where the bit advances, does not end the advance early") {
  for (const double push : {0.0, 20.0}) {
    CAPTURE(push);
    FeedHandConfig config{.feed = 0.0005, .stop = 0.002, .compliance = 1.0 / 5000.0};
    if (push > 0.0) config.push = push;
    Bone bone;
    int tick = 0;
    run(make(config), [&](double height) {
      const double force = bone(height);
      return tick++ % 20 < 3 ? 0.8 * force : force;  // 0.8 mm of the coupling at 20 N
    });
    CHECK(-bone.face >= config.stop - 1e-12);
    CHECK(-bone.face < config.stop + 0.02e-3);
  }
}

TEST_CASE("FeedHand: a fixed thrust rises over the ramp, is carried by bone, and drills at the speed of its force") {
  const FeedHandConfig config{.feed = 0.005, .push = 20.0, .stop = 0.003, .ramp = 0.5, .compliance = 1.0 / 5000.0};
  Bone bone;
  FeedHand hand = make(config);
  std::uint64_t lean = 0;
  double before = 0.0, face_before = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const HandState state = hand.read();
    if (state.phase == HandPhase::lean && lean == 0) lean = state.tick;
    const double since = static_cast<double>(state.tick - lean) * kPeriod;
    if (lean > 0 && state.phase == HandPhase::lean && since > config.ramp + kPeriod) REQUIRE(state.thrust == *config.push);
    if (lean > 0 && since < config.ramp) REQUIRE(state.thrust <= *config.push * (since / config.ramp) + 1.1 * config.contact_force);
    hand.apply({{0.0, 0.0, bone(state.world_from_hand.translation.z)}, Vec3(0.0)});
    if (n == 2500) before = bone.force, face_before = bone.face;
    if (n == 3500) CHECK(face_before - bone.face == doctest::Approx(bone.rate * *config.push).epsilon(0.01));
  }
  // 20 N less b v, 10 N s/m at 0.4 mm/s.
  CHECK(std::abs(before - 20.0) < 0.02);
}

TEST_CASE("FeedHand: it does not react to breakthrough, goes on to the stop and no deeper") {
  for (const double push : {0.0, 10.0, 80.0}) {
    CAPTURE(push);
    FeedHandConfig config{.feed = 0.001, .stop = 0.006, .compliance = 1.0 / 5000.0};
    if (push > 0.0) config.push = push;
    Bone bone{.thickness = 0.001};
    const auto ticks = run(make(config), std::ref(bone));
    REQUIRE(ticks.back().state.phase == HandPhase::done);
    CHECK(bone.force == 0.0);
    // Under 80 N the carriage is at 16 mm when the face is through: the coupling, which lets the drill go, ends the advance there.
    const double loaded = push / bone.coupling;
    CHECK(deepest(ticks) >= config.stop - 1e-12);
    CHECK(deepest(ticks) <= std::max(config.stop, 0.001 + loaded) + 0.1e-3);
  }
}

TEST_CASE("FeedHand: create refuses values outside their ranges") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [](const FeedHandConfig& config, double period = kPeriod) {
    const auto hand = FeedHand::create(config, {}, period);
    return !hand.ok() && hand.error().code == ErrorCode::out_of_range;
  };
  CHECK_FALSE(refuses({}));
  for (double FeedHandConfig::*value :
       {&FeedHandConfig::feed, &FeedHandConfig::stop, &FeedHandConfig::ramp, &FeedHandConfig::contact_force, &FeedHandConfig::standoff,
        &FeedHandConfig::mass, &FeedHandConfig::damping, &FeedHandConfig::compliance})
    for (const double bad : {-1e-9, nan}) {
      FeedHandConfig config;
      config.*value = bad;
      CHECK(refuses(config));
    }
  for (const double bad : {0.0, -1.0, nan}) {
    CHECK(refuses({.push = bad}));
    CHECK(refuses({}, bad));
  }
}
