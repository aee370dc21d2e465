// A hand that effects push: it feels the sum, and takes neither what carries a part of its thrust for bone, nor what shakes it for its end.

#include <doctest/doctest.h>

#include "tests/haptics/hand/two_face_bit.h"

namespace burrhole::test {

TEST_CASE("SimulatedHand: a force that effects add is no bone: the end of all bone is felt though it goes on, and it is no first contact") {
  for (const double push : kPushes)
    for (const double gone : {1.2, 4.0})
      for (const double part : {0.05, 0.3, 0.6}) {
        CAPTURE(push);
        CAPTURE(gone);
        CAPTURE(part);
        const Felt felt = drill({.push = push, .gone_at = gone, .added = part}, {});
        CHECK(static_cast<double>(felt.tick) * kPeriod > gone);
        CHECK(felt.advance > 0.0);
        CHECK(felt.advance < 0.3e-3);
      }
  // It alone is no contact, so the hand goes on to approach. Sabotage: a hand that takes it for one leans.
  for (const bool aware : {true, false}) {
    auto hand = SimulatedHand::create({}, Pose{}, kPeriod);
    REQUIRE(hand);
    for (int n = 0; n < 200; ++n) {
      if (aware) hand->added_force({0.0, 0.0, 2.0});
      hand->apply({{0.0, 0.0, 2.0}, Vec3(0.0)});
    }
    CHECK(hand->read().phase == (aware ? HandPhase::approach : HandPhase::lean));
  }
}

TEST_CASE("SimulatedHand: a hand that effects push goes by the drill: a force that shakes it is no breakthrough, a lost engagement is") {
  for (const double push : kPushes) {
    CAPTURE(push);
    // At twice its limit on the force that is missing, at 20 Hz, near the frequency of the hand on the coupling.
    const Layers shaken{.push = push, .shakes = 2.0 / 3.0 * push * kCoupling / (kCoupling + kCut)};
    CHECK(drill(shaken, {}).tick == 0);
    Layers ends = shaken;
    ends.falls_at = 3.0;
    const Felt felt = drill(ends, {});
    CHECK(felt.tick > 3000);
    CHECK(felt.tick < 3020);
    Layers unaware = shaken;  // sabotage: as if bone shook it
    unaware.aware = false;
    CHECK(drill(unaware, {}).tick > 0);
  }
}

}  // namespace burrhole::test
