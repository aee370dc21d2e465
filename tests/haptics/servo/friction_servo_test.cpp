// friction between two contact results: the cone at every servo tick, and no creep, in every form of contact.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "haptics/servo/multi_rate.h"
#include "tests/core/contact/friction_support.h"
#include "tests/support/local_states.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kMu = 0.3;
constexpr int kEvery = 10;  // servo ticks in a contact period
constexpr double kPi = std::numbers::pi;

Friction friction_of(double coefficient) {
  auto made = Friction::create({.static_coefficient = coefficient, .kinetic_coefficient = coefficient});
  REQUIRE(made.ok());
  return *made;
}

/// Contact every kEvery ticks, the servo at each, a law for each of them.
class Loop {
 public:
  Loop(const Form& form, MultiRateScheme scheme, double servo_coefficient)
      : model_(form.make(pad(), {.voxel_edge = kPitch, .planes = true, .foresight = 2.0 * kEvery * kTick})),
        at_contact_(friction_of(kMu)),
        at_servo_(friction_of(servo_coefficient)),
        multi_rate_({.scheme = scheme, .contact_ticks = kEvery}) {
    multi_rate_.use_tangential_law(&at_servo_);
  }
  Wrench tick(HandState hand) {
    if (tick_ == 0) model_->place(hand.world_from_hand);
    hand.tick = tick_;
    if (tick_++ % kEvery == 0) {
      const BoneView bone = plate_bone().view();
      model_->step({.bone = bone, .hand = hand, .dt = kEvery * kTick, .added = {.tangential = &at_contact_}}, state_);
      state_.tick = hand.tick;
      ++state_.number;
    }
    return multi_rate_(state_, hand, kTick);
  }

 private:
  std::unique_ptr<ContactModel> model_;
  Friction at_contact_, at_servo_;
  MultiRate multi_rate_;
  ContactState state_;
  std::uint64_t tick_ = 0;
};

/// Largest share of the cone that the servo's force has while a hand rubs to and fro.
double largest_share(const Form& form, MultiRateScheme scheme, double servo_coefficient) {
  Loop loop(form, scheme, servo_coefficient);
  const double deep = form.name.starts_with("voxmap") ? 0.32e-3 : 0.12e-3;
  double largest = 0.0;
  HandState hand;
  for (int n = 0; n < 2000; ++n) {
    const double t = n * kTick;
    const Vec3 before = hand.world_from_hand.translation;
    hand.world_from_hand.translation = {0.5e-3 * std::sin(2.0 * kPi * 3.0 * t), 0.3e-3 * std::sin(2.0 * kPi * 2.0 * t),
                                        n < 100 ? 1e-4 - (1e-4 + deep) * n / 100.0 : -deep * (1.0 + 0.1 * std::sin(2.0 * kPi * 5.0 * t))};
    hand.velocity = n > 0 ? (hand.world_from_hand.translation - before) / kTick : Vec3(0.0);
    const Vec3 force = loop.tick(hand).force;
    if (n > 200 && force.z > 0.01) largest = std::max(largest, std::hypot(force.x, force.y) / (kMu * force.z));
  }
  return largest;
}

/// [m] by which a body of 0.2 kg creeps in 10 s under an oscillating load of half the cone.
double drift(const Form& form) {
  Loop loop(form, MultiRateScheme::planes, kMu);
  HandState hand;
  hand.world_from_hand.translation = Vec3(0.0, 0.0, 1e-5);
  const auto run = [&](double seconds, double share) {
    for (int n = 0; n < static_cast<int>(seconds / kTick); ++n) {
      const double t = n * kTick;
      const Vec3 push(share * kMu * 3.0 * std::sin(2.0 * kPi * 7.1 * t), share * kMu * 3.0 * std::sin(2.0 * kPi * 3.3 * t),
                      -3.0 * (1.0 + 0.4 * share * std::sin(2.0 * kPi * 11.3 * t)));
      hand.velocity += kTick / 0.2 * (push + loop.tick(hand).force - 20.0 * hand.velocity);
      hand.world_from_hand.translation += kTick * hand.velocity;
    }
  };
  run(0.5, 0.0);
  run(1.0, 0.35);
  run(1.0, 0.0);
  const Vec3 before = hand.world_from_hand.translation;
  run(10.0, 0.35);
  run(1.0, 0.0);
  const Vec3 moved = hand.world_from_hand.translation - before;
  return std::hypot(moved.x, moved.y);
}

/// The groove of two walls, `half` [rad] from its middle plane, that touch the tool 3 mm beside its origin.
ContactState groove_of(double half) {
  const auto wall = [&](double side) {
    HoldPlane out = test::make_plane(Vec3(-side * std::cos(half), 0.0, std::sin(half)), 0.0, 5e-8, side > 0.0 ? 1u : 2u);
    out.arm = Vec3(side * 3e-3, 0.0, 0.0);
    return out;
  };
  return test::coupled_state({wall(-1.0), wall(1.0)}, 5000.0, 10.0);
}

/// [-] Resistance over thrust of a tool that is pressed into a groove by `deep` [m] and drawn along it, and how much that varies in the last
/// tenth of a second.
struct Drawn {
  double share, varies;
};
Drawn draw_along_groove(double half, double deep, double coefficient) {
  const ContactState state = groove_of(half);
  Friction law = friction_of(coefficient);
  LocalTool tool;
  tool.renew(state, 1.0);
  Drawn out{0.0, 0.0};
  for (int n = 0; n < 600; ++n) {
    Pose hand = state.world_from_hand;
    hand.translation += Vec3(0.2e-3 * std::sin(0.02 * std::min(n, 300)), 5e-6 * n, -deep);
    const Vec3 force = tool.step(state, hand, Vec3(0.0, 5e-3, 0.0), kTick, &law).force;
    const double share = -force.y / force.z;
    if (n >= 500) out.varies = std::max(out.varies, std::abs(share - out.share));
    if (n >= 499) out.share = share;
  }
  return out;
}

/// A tool that a hand presses into a groove by 1 mm, lets go in 0.6 s, and then draws out of it with `pull` [N].
struct Wedged {
  double force;  // [N] on the hand along the groove's middle plane, out of it
  double moves;  // [m] of the tool while the hand draws
};
Wedged pull_out(double half, double pull, double coefficient) {
  constexpr double kDeep = 1e-3, kStiffness = 5000.0;
  const ContactState state = groove_of(half);
  Friction law = friction_of(coefficient);
  LocalTool tool;
  tool.renew(state, 1.0);
  Wedged out{0.0, 0.0};
  double before = 0.0, held = 0.0;
  for (int n = 0; n < 1500; ++n) {
    const double part = std::clamp((n - 300) / 600.0, 0.0, 1.0);
    const double height = -kDeep * std::min(1.0, n / 300.0) + part * (kDeep + pull / kStiffness);
    Pose hand = state.world_from_hand;
    hand.translation.z += height;
    out.force = tool.step(state, hand, Vec3(0.0, 0.0, (height - before) / kTick), kTick, &law).force.z;
    before = height;
    const double at = tool.world_from_tool().translation.z;
    if (n == 1000) held = at;
    if (n > 1000) out.moves = std::max(out.moves, std::abs(at - held));
  }
  return out;
}

}  // namespace

TEST_CASE("friction at the servo: a tool wedged between walls steeper than the angle of friction stays until it is drawn out") {
  constexpr double kThrust = 5.0;  // [N]
  for (const double degrees : {5.0, 10.0, 14.0}) {
    CAPTURE(degrees);
    const double half = degrees * kPi / 180.0;
    // Pressed in, each wall carries N; it keeps it while nothing slides, and friction holds against a pull until both walls are at the cone.
    const double normal = 0.5 * kThrust / (std::sin(half) + kMu * std::cos(half));
    const double most = 2.0 * normal * (kMu * std::cos(half) - std::sin(half));
    for (const double share : {0.3, 0.8}) {
      const Wedged held = pull_out(half, share * most, kMu);
      std::printf("wedge of %g degrees, %.4f N outwards: %.4f N held\n", degrees, share * most, -held.force);
      CHECK(held.moves < 1e-12);
      // The tool stands a few um deeper than the hand's zero by the walls' yield, which the coupling feels.
      CHECK(std::abs(-held.force - share * most) < 5000.0 * 2.0 * 5e-8 * normal / std::sin(half) + 1e-3);
    }
    CHECK(pull_out(half, 1.3 * most, kMu).force == 0.0);
    CHECK(pull_out(half, 0.3 * most, 0.8 * std::tan(half)).force == 0.0);  // a wedge that is too wide for its friction
  }
}

TEST_CASE("friction at the servo: along a groove the resistance is mu over the sine of half its angle, down to steep walls") {
  for (const double degrees : {60.0, 30.0, 12.0, 5.0}) {
    CAPTURE(degrees);
    const double half = degrees * kPi / 180.0, expected = kMu / std::sin(half);
    const Drawn found = draw_along_groove(half, 0.5e-3, kMu);
    std::printf("groove of %g degrees: %.6f of the thrust, %.6f expected\n", degrees, found.share, expected);
    // A tick leaves 1e-4 of the normal loads, which are expected / mu times the thrust.
    CHECK(std::abs(found.share - expected) < 1e-4 * expected / kMu);
    CHECK(found.varies < 1e-4 * expected / kMu);
    CHECK(std::abs(draw_along_groove(half, 0.5e-3, 1.002 * kMu).share - expected) > 1e-4 * expected / kMu);  // sabotage
  }
}

TEST_CASE("friction at the servo: between contact results the force stays in the cone, and is on it while the hand rubs") {
  for (const Form& form : every_form())
    for (const MultiRateScheme scheme : {MultiRateScheme::gradient, MultiRateScheme::planes}) {
      CAPTURE(form.name);
      CAPTURE(name_of(scheme));
      const double share = largest_share(form, scheme, kMu);
      std::printf("servo, %s, %s: %.6f of the cone\n", form.name.c_str(), name_of(scheme), share);
      CHECK(share < 1.01);
      CHECK(share > 0.99);
      CHECK(largest_share(form, scheme, 2.0) > 1.01);  // sabotage: a cone seven times as wide
    }
}

TEST_CASE("friction at the servo: within the cone a body does not creep in 10 s") {
  for (const Form& form : every_form()) {
    CAPTURE(form.name);
    const double crept = drift(form);
    std::printf("servo creep in 10 s, %s: %.3g m\n", form.name.c_str(), crept);
    // A tick leaves up to 1e-12 m, which the next takes back; 1e4 of them that added up would be 1e-8 m.
    CHECK(crept < 1e-10);
  }
}
