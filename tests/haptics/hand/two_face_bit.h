/// tests/haptics/hand/two_face_bit.h: a bit of two faces in a cutting law of its own, under the script's hand: the drill, without mass, is engaged
///   by F / K_cut, on a coupling K to the hand, and the face that carries it recedes in proportion to the force. Where that face leaves bone the
///   bit falls by what is lost of its engagement.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "haptics/hand/simulated_hand.h"

namespace burrhole::test {

inline constexpr double kPeriod = 1e-3;                    // [s]
inline constexpr double kCoupling = 5000.0, kCut = 140e3;  // [N/m]

struct Layers {
  double push = 28.0;                                 ///< [N]
  double expects = kCoupling / (kCoupling + kCut);    ///< [-] exit_drop of the hand
  double compliance = 1.0 / kCut;                     ///< [m/N] cut_compliance of the hand
  double soft_from = 1e9, soft_to = 1e9;              ///< [s] softer bone: three times the feed
  double thins_from = 1e9, thins_in = 0.05;           ///< [s] a rim that thins: the feed grows by e in each `thins_in`
  double falls_at = 1e9, falls = 1.0, gone_at = 1e9;  ///< [s] share of the engagement that is then lost, and the time without any bone
  double added = 0.0;                                 ///< [-] part of the thrust that effects carry
  double shakes = 0.0;                                ///< [N] amplitude of a force of effects at 20 Hz, from 2 s on
  bool aware = true;                                  ///< the hand knows of these
};

/// @returns the tick at which breakthrough is detected, 0 for none, and how far the hand has advanced since the last change.
struct Felt {
  std::uint64_t tick = 0;
  double advance = 0.0;  ///< [m]
};
inline Felt drill(const Layers& layers, HandConfig config, double ends = 8.0) {
  config.push = layers.push;
  config.exit_drop = layers.expects;
  config.cut_compliance = layers.compliance;
  const bool pushed = layers.added > 0.0 || layers.shakes > 0.0;
  if (pushed) config.rough_drop = 0.5;  // 0.4 of a voxel of 0.25 mm times the coupling, as in a scene
  auto made = SimulatedHand::create(config, Pose{}, kPeriod);
  REQUIRE(made);
  SimulatedHand hand = *made;
  if (pushed && layers.aware) hand.watch_drill();
  const double series = kCoupling * kCut / (kCoupling + kCut);
  double face = 0.0, force = 0.0, changed_at = 0.0;
  for (std::uint64_t n = 0; static_cast<double>(n) * kPeriod < ends; ++n) {
    const HandState state = hand.read();
    const double t = static_cast<double>(n) * kPeriod, height = state.world_from_hand.translation.z;
    if (state.phase > HandPhase::lean) return {n, changed_at - height};
    const auto passes = [&](double at) { return t >= at && t - kPeriod < at; };
    if (passes(layers.soft_from) || passes(layers.falls_at) || passes(layers.gone_at)) changed_at = height;
    if (passes(layers.falls_at)) face -= layers.falls * force / kCut;
    force = t < layers.gone_at ? std::max(0.0, series * (face - height)) : 0.0;
    const bool soft = t > layers.soft_from && t < layers.soft_to;
    const double thins = std::exp(std::max(0.0, t - layers.thins_from) / layers.thins_in);
    face -= force / 28.0 * (soft ? 1.2e-3 : 0.4e-3) * thins * kPeriod;
    Vec3 added(0.0, 0.0, layers.added * state.thrust);
    if (t > 2.0) added.z += layers.shakes * std::sin(2.0 * std::numbers::pi * 20.0 * t);
    hand.drill_at({0.0, 0.0, height + force / kCoupling});
    if (pushed && layers.aware) hand.added_force(added);
    hand.apply({Vec3(0.0, 0.0, force) + added, Vec3(0.0)});
  }
  return {};
}
inline constexpr std::array<double, 5> kPushes{10.0, 15.0, 28.0, 50.0, 80.0};

}  // namespace burrhole::test
