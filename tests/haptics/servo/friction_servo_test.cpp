// friction between two contact results: the cone at every servo tick, and no creep, in every form of contact.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "haptics/servo/multi_rate.h"
#include "tests/core/contact/friction_support.h"

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
  Wrench tick(const HandState& hand) {
    if (tick_ == 0) model_->place(hand.world_from_hand);
    if (tick_++ % kEvery == 0) {
      const BoneView bone = plate_bone().view();
      model_->step({.bone = bone, .hand = hand, .dt = kEvery * kTick, .added = {.tangential = &at_contact_}}, state_);
      ++state_.number;
    }
    return multi_rate_(state_, hand, kTick);
  }

 private:
  std::unique_ptr<ContactModel> model_;
  Friction at_contact_, at_servo_;
  MultiRate multi_rate_;
  ContactState state_;
  int tick_ = 0;
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

}  // namespace

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
