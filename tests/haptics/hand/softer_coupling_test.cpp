// A coupling that becomes softer, as on soft bone with felt hardness: it takes force off the hand and lets it advance by millimetres, and is no
// breakthrough. The hand tells the two apart by the drill, which stays on bone.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "haptics/hand/simulated_hand.h"

namespace burrhole::test {
namespace {

constexpr double kPeriod = 1e-3, kCoupling = 5000.0, kCut = 140e3;  // [s], [N/m], [N/m]
constexpr double kNever = 1e9;                                      // [s]
constexpr std::array<double, 5> kPushes{10.0, 15.0, 28.0, 50.0, 80.0};
constexpr std::array<double, 4> kShares{0.1, 0.3, 0.6, 0.75};  // with more, 80 N take the arm to its reach

struct Bone {
  double push = 28.0;                     ///< [N]
  double share = 0.6;                     ///< [-] by which the coupling becomes softer, at most
  double softer_at = kNever;              ///< [s]
  double time = 0.02;                     ///< [s] time constant of that
  double harder_at = kNever;              ///< [s] it becomes as at the start again, with 0.3 s: only the work of cutting pays for it
  double falls_at = kNever, falls = 1.0;  ///< [s] share of the engagement that the bit then loses; a next face carries the thrust
  double gone_at = kNever;                ///< [s] without any bone
  bool watches = true;                    ///< the hand watches the drill
  bool dead = false;                      ///< sabotage: the drill is reported where it was at first
};

/// The drill has no mass: it is engaged by F / K_cut in a face that recedes by 0.4 mm/s at 28 N, and the hand pushes it through the coupling.
/// @returns the time at which breakthrough is detected; 0: never.
double felt_at(const Bone& bone, double ends = 8.0) {
  HandConfig config;
  config.push = bone.push;
  config.exit_drop = kCoupling / (kCoupling + kCut);
  config.cut_compliance = 1.0 / kCut;
  config.watches_drill = bone.watches;
  auto hand = SimulatedHand::create(config, Pose{}, kPeriod);
  REQUIRE(hand);
  double face = 0.0, force = 0.0, factor = 1.0;
  for (int n = 0; n * kPeriod < ends; ++n) {
    const HandState state = hand->read();
    const double t = n * kPeriod, height = state.world_from_hand.translation.z;
    if (state.phase > HandPhase::lean) return t;
    const bool soft = t >= bone.softer_at && t < bone.harder_at;
    factor += ((soft ? 1.0 - bone.share : 1.0) - factor) * kPeriod / (soft ? bone.time : 0.3);
    if (t >= bone.falls_at && t - kPeriod < bone.falls_at) face -= bone.falls * force / kCut;
    const double coupling = factor * kCoupling, series = coupling * kCut / (coupling + kCut);
    force = t < bone.gone_at ? std::max(0.0, series * (face - height)) : 0.0;
    face -= force / 28.0 * 0.4e-3 * kPeriod;
    hand->drill_at({0.0, 0.0, bone.dead ? 0.0 : height + force / coupling});
    hand->apply({{0.0, 0.0, force}, Vec3(0.0)});
  }
  return 0.0;
}

}  // namespace

TEST_CASE("softer coupling: it is no breakthrough at any push, which it is to a hand that does not watch the drill") {
  for (const double push : kPushes)
    for (const double share : kShares) {
      CAPTURE(push);
      CAPTURE(share);
      CHECK(felt_at({.push = push, .share = share, .softer_at = 3.0}) == 0.0);
      CHECK(felt_at({.push = push, .share = share, .softer_at = 3.0, .harder_at = 5.0}) == 0.0);
      CHECK(felt_at({.push = push, .share = share, .softer_at = 3.0, .time = 0.3}) == 0.0);
      CHECK(felt_at({.push = push, .share = share, .softer_at = 3.0, .watches = false}) > 3.0);  // sabotage
    }
}

TEST_CASE("softer coupling: a bit that loses its engagement is felt within 2 ms, before, while and after the coupling becomes softer") {
  // The next tick has the force and the place of the drill after the fall: three quarters of the engagement, where half of it is the limit.
  for (const double push : kPushes)
    for (const double falls : {0.75, 1.0})
      for (const double softer : {kNever, 2.5, 2.98, 3.0}) {
        CAPTURE(push);
        CAPTURE(falls);
        CAPTURE(softer);
        const double at = felt_at({.push = push, .softer_at = softer, .falls_at = 3.0, .falls = falls});
        CHECK(at > 3.0 - 0.5 * kPeriod);
        CHECK(at < 3.0 + 2.5 * kPeriod);
        CHECK(felt_at({.push = push, .softer_at = softer, .falls_at = 3.0, .falls = falls, .dead = true}, 4.0) == 0.0);  // sabotage
      }
}

TEST_CASE("softer coupling: a third of the engagement, lost in pores while the coupling becomes softer, is no breakthrough") {
  for (const double push : kPushes) {
    CAPTURE(push);
    CHECK(felt_at({.push = push, .softer_at = 3.0, .falls_at = 3.0, .falls = 1.0 / 3.0}) == 0.0);
  }
}

TEST_CASE("softer coupling: the end of all bone is felt within 30 ms, whatever the coupling does") {
  for (const double push : kPushes)
    for (const double softer : {kNever, 2.5, 3.0}) {
      CAPTURE(push);
      CAPTURE(softer);
      const double at = felt_at({.push = push, .softer_at = softer, .gone_at = 3.0});
      CHECK(at > 3.0);
      CHECK(at < 3.03);
    }
}

TEST_CASE("softer coupling: a hand that watches the drill must know the cutting stiffness") {
  for (const auto& [drop, compliance] : {std::pair{1.0, 1.0 / kCut}, {0.5, 0.0}}) {
    HandConfig config;
    config.watches_drill = true;
    config.exit_drop = drop;
    config.cut_compliance = compliance;
    const auto hand = SimulatedHand::create(config, Pose{}, kPeriod);
    REQUIRE_FALSE(hand);
    CHECK(hand.error().code == ErrorCode::out_of_range);
  }
}

TEST_CASE("softer coupling: a drill at a place that is not finite is ignored") {
  HandConfig config;
  config.exit_drop = kCoupling / (kCoupling + kCut);
  config.cut_compliance = 1.0 / kCut;
  config.watches_drill = true;
  auto hand = SimulatedHand::create(config, Pose{}, kPeriod), twin = SimulatedHand::create(config, Pose{}, kPeriod);
  REQUIRE(hand);
  REQUIRE(twin);
  for (int n = 0; n < 3000; ++n) {
    const double z = hand->read().world_from_hand.translation.z, push = std::max(0.0, -5000.0 * z);
    for (auto* const one : {&*hand, &*twin}) {
      one->drill_at({0.0, 0.0, -push / kCut});
      if (one == &*twin && n % 3 == 0) one->drill_at(Vec3(std::nan("")));
      one->apply({{0.0, 0.0, push}, Vec3(0.0)});
    }
    REQUIRE(hand->read().world_from_hand.translation == twin->read().world_from_hand.translation);
  }
  CHECK(hand->read().phase == HandPhase::lean);
}

}  // namespace burrhole::test
