// [erosion] law = "progressive" in a scene: each key changes the removed volume, or the stress at which bone goes, by a stated amount.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kSpin = 1000.0 / 60.0, kHardness = 0.8, kStep = 0.02;  // [rev/s], [-], [s]
constexpr std::size_t kTicks = 20;                                      // of the servo in a bone step
// [m] side of the voxels that have bone of a post of 2 mm: its density falls over two voxels, of which one is outside.
constexpr double kEngaged = 2.5e-3;

/// Two lines, to the yield point and to fracture.
struct Curve {
  double yield_strain = 115e6 / 17e9, yield = 115e6, strain = 0.031, strength = 133e6;  // the default
  [[nodiscard]] double toughness() const {
    return 0.5 * yield * yield_strain + 0.5 * (yield + strength) * (strain - yield_strain);
  }  // [J/m^3]
  /// The share of bone that goes under a stress: the area up to it, less what a spring gives back.
  [[nodiscard]] double damage(double stress) const {
    const double part = (strain - yield_strain) * (stress - yield) / (strength - yield), modulus = yield / yield_strain;
    return (0.5 * yield * yield_strain + 0.5 * (yield + stress) * part - 0.5 * stress * stress / modulus) / toughness();
  }
  [[nodiscard]] std::string key() const {
    return fmt::format("erosion.curve=[{{strain={:.17g}, stress_MPa={:.17g}}}, {{strain={:.17g}, stress_MPa={:.17g}}}]", yield_strain,
                       yield / 1e6, strain, strength / 1e6);
  }
};

/// A flat cylinder on a post of bone that is narrower, so that all of it is under the bit and there is no wall.
struct Drilled {
  std::vector<double> removed, force;    // [m^3], [N] after and in each bone step
  double stress = 0.0, near_face = 0.0;  // [Pa] largest; [m^3] of bone less than half a millimetre below the face
};
Drilled drilled(std::vector<std::string> sets) {
  sets.insert(sets.end(), {"tool.name=\"punch\"", "erosion.law=\"progressive\""});
  LoadedScene loaded = load_small(SmallScene{.volume = kPostKeys, .sets = sets});
  Drilled out;
  const double* removed = nullptr;
  Simulation* simulation = nullptr;
  std::size_t ticks = 0;
  double sum = 0.0;
  WatchedHand hand(loaded, [&] {
    sum += simulation->contact_state().on_hand.force.z;
    if (++ticks % kTicks != 0) return;
    out.removed.push_back(*removed);
    out.force.push_back(sum / static_cast<double>(kTicks));
    sum = 0.0;
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  simulation = &run.simulation();
  for (const StepColumn& column : simulation->stage().graph.columns(Clock::simulation))
    if (column.name == "removed_mass") removed = column.value;
  REQUIRE(removed != nullptr);
  run.run();
  out.stress = figure(run.simulation(), "erosion", "largest_stress_MPa") * 1e6;
  const BoneModel& bone = *run.loaded().bone;
  std::vector<float> occupancy(bone.bounds().count());
  bone.read_occupancy(bone.bounds(), occupancy);
  std::size_t n = 0;
  for_each_voxel(bone.bounds(), [&](const Vec3i& voxel) {
    if ((bone.bone_from_index() * Vec3(voxel)).z > -0.5e-3)
      out.near_face += static_cast<double>(occupancy[n]) * bone.bone_from_index().cell_volume();
    ++n;
  });
  return out;
}

/// [m] Mean distance from the axis of the points of the bit, 0.125 mm apart, in the voxels of the post.
double mean_radius() {
  constexpr int kPoints = 20;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j) sum += std::hypot((i + 0.5) / kPoints - 0.5, (j + 0.5) / kPoints - 0.5);
  return kEngaged * sum / (kPoints * kPoints);
}

}  // namespace

TEST_CASE("progressive law: work_share, cutting_ratio and the curve give the volume that is removed by the work of cutting") {
  // Of the work mu F 2 pi n r dt the share w deforms bone, which takes h U: V = w mu 2 pi n r / (h U) x the integral of F, with F as the hand gets it. F changes by less
  // than half a per cent in a step, so that an end of the sum in another tick counts 0.1 % of some thirty steps.
  struct Case {
    double share, ratio;
    Curve curve;
  };
  Curve tough, steep{.yield_strain = 0.004, .yield = 100e6, .strain = 0.02, .strength = 180e6};
  tough.strain = 0.05;
  for (const Case& one : {Case{0.034, 0.5, {}}, {0.02, 0.5, {}}, {0.034, 0.35, {}}, {0.034, 0.5, tough}, {0.034, 0.5, steep}}) {
    CAPTURE(one.share);
    CAPTURE(one.ratio);
    CAPTURE(one.curve.strain);
    const Drilled run = drilled({"duration_s=3.0", fmt::format("erosion.work_share={}", one.share),
                                 fmt::format("erosion.cutting_ratio={}", one.ratio), one.curve.key()});
    double impulse = 0.0, from = 0.0, to = 0.0;
    std::size_t steps = 0;
    for (std::size_t n = 1; n < run.removed.size(); ++n) {
      if (run.removed[n - 1] < 2e-9 || run.removed[n] > 12e-9) continue;
      if (steps++ == 0) from = run.removed[n - 1];
      to = run.removed[n];
      impulse += run.force[n] * kStep;
    }
    REQUIRE(steps > 25);
    const double expected =
        one.share * one.ratio * 2.0 * std::numbers::pi * kSpin * mean_radius() / (kHardness * one.curve.toughness()) * impulse;
    MESSAGE("removed " << (to - from) * 1e9 << " mm3 in " << steps << " steps, expected " << expected * 1e9);
    CHECK(std::abs((to - from) / expected - 1.0) < 0.005);
    CHECK(std::abs((to - from) / (1.1 * expected) - 1.0) > 0.05);  // sabotage: a tenth more of one of the keys
  }
  CHECK(drilled({"duration_s=1.0", "tool.spin_rpm=0"}).removed.back() == 0.0);
}

TEST_CASE("progressive law: bearing_share gives the stress under the bit, and the curve the share of bone that goes under it") {
  // The stress is F over the share of the projected area of the engaged voxels. Between yield and fracture all of the bone that the bit reaches, two layers and that of the
  // face's ramp, loses the share of the curve, and less than half of it, so the bit stays there. The thrust
  // rises by up to 1e-4 in the last steps, of which the slope of the curve makes 1e-3.
  struct Case {
    double share;
    Curve curve;
  };
  const Curve steep{.yield_strain = 0.004, .yield = 100e6, .strain = 0.02, .strength = 180e6};
  for (const Case& one : {Case{0.0326, {}}, {0.03235, {}}, {0.0276, steep}}) {
    CAPTURE(one.share);
    const Drilled run =
        drilled({"duration_s=3.0", "contact.cutting_N_per_m=80e3", fmt::format("erosion.bearing_share={}", one.share), one.curve.key()});
    const double force = *std::ranges::max_element(run.force), stress = force / (one.share * kEngaged * kEngaged);
    const double damage = one.curve.damage(run.stress / kHardness), found = run.removed.back() / run.near_face;
    MESSAGE("stress " << run.stress / 1e6 << " MPa, expected " << stress / 1e6 << "; removed " << found << " of " << run.near_face * 1e9
                      << " mm3, expected " << damage);
    CHECK(std::abs(run.stress / stress - 1.0) < 0.002);
    CHECK(std::abs(found / damage - 1.0) < 0.001);
    CHECK(std::abs(found / one.curve.damage(1.02 * run.stress / kHardness) - 1.0) > 0.05);  // sabotage: two hundredths less of the share
  }
  // A hundredth below the yield point, and a hundredth above it: 20.07 N, at the end of these runs, over 0.0349 of the face.
  CHECK(drilled({"duration_s=2.0", "erosion.bearing_share=0.0353"}).removed.back() == 0.0);
  CHECK(drilled({"duration_s=2.0", "erosion.bearing_share=0.0345"}).removed.back() > 0.0);
}

}  // namespace burrhole::test
