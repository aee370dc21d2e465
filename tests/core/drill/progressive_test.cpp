// Law `progressive`: the curve against closed forms and a plain sum of small strains; the work of removal against the work of cutting; each voxel
// against a plain bisection for its damage; the laws that every removal must obey: spin off, rate of steps, hardness, a stress that is too small.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/random.h"
#include "core/drill/progressive_removal.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdge = 0.25e-3, kRadius = 3e-3;  // [m]
constexpr double kMu = 0.4, kWorkShare = 0.05, kBearing = 0.01;

// 20 GPa to 100 MPa at 0.5 %; then to 150 MPa at 2 %, and down to 120 MPa at 3 %.
const std::vector<StressStrainPoint> kPoints{{0.005, 100e6}, {0.02, 150e6}, {0.03, 120e6}};
constexpr double kToughness = 0.5 * 0.005 * 100e6 + 0.5 * 0.015 * 250e6 + 0.5 * 0.010 * 270e6;

StressStrainCurve curve() {
  auto made = StressStrainCurve::create(kPoints);
  REQUIRE(made);
  return made.value();
}

ErosionConfig law() {
  ErosionConfig out{.law = ErosionLaw::progressive};
  out.energy.cutting_ratio = kMu;
  out.progressive = {.curve = curve(), .work_share = kWorkShare, .bearing_share = kBearing};
  return out;
}

ErosionPoints ball_points() { return lattice(Ball{kRadius}, kEdge / 2.0, 1.0f); }
Affine pressed(double edge = kEdge) { return upright_pose(edge, Vec3(31.37, 32.21, 39.5 - 1.5e-3 / edge)); }
Voxmap plane(float hardness = 1.0f, double edge = kEdge) {
  return Block{.dims = Vec3i(64, 64, 40), .pitch = edge, .hardness = hardness}.make();
}

/// Numbers in a range, one after the other.
struct Random {
  std::uint64_t seed, count = 0;
  double uniform(double low, double high) { return low + (high - low) * uniform01(seed, count++); }
};

/// The force [N] that puts the ball under that stress.
double force_for(double stress) {
  Voxmap bone = plane();
  Erosion probe = make_erosion(ball_points(), law());
  return stress / probe.step(bone, {pressed(), pressed()}, {.spin = 1e-12, .force = 1.0}, 1e-3).stress;
}

/// Damage by a stress, from 200,000 small strains: the work of each, less what a spring of the first slope gives back.
double plain_damage(double stress) {
  const auto at = [](double strain) {
    double from = 0.0, low = 0.0;
    for (const StressStrainPoint& p : kPoints) {
      if (strain <= p.strain) return low + (p.stress - low) * (strain - from) / (p.strain - from);
      from = p.strain, low = p.stress;
    }
    return 0.0;
  };
  constexpr int kSteps = 200000;
  const double step = kPoints.back().strain / kSteps;
  double work = 0.0, all = 0.0;
  bool reached = false;
  for (int n = 0; n < kSteps; ++n) {
    const double here = at((n + 0.5) * step);
    reached = reached || here > stress;
    if (!reached) work += here * step;
    all += here * step;
  }
  return reached ? (work - stress * stress / (2.0 * 20e9)) / all : 1.0;
}

}  // namespace

TEST_CASE(
    "stress-strain: toughness is the area, damage that of small strains, elastic below the yield point and whole from the strength on") {
  const StressStrainCurve c = curve();
  CHECK(std::abs(c.toughness() - kToughness) < 1e-12 * kToughness);
  CHECK(c.strength() == 150e6);
  // Bilinear, by hand: to 125 MPa the second line goes half way, to a strain of 1.25 %.
  const double half = (0.5 * 0.005 * 100e6 + 0.5 * 0.0075 * 225e6 - 125e6 * 125e6 / 40e9) / kToughness;
  CHECK(std::abs(c.damage_at(125e6) - half) < 1e-12);
  for (const double stress : {0.0, 50e6, 100e6}) CHECK(c.damage_at(stress) == 0.0);
  for (const double stress : {150e6, 151e6, 1e12}) CHECK(c.damage_at(stress) == 1.0);
  // A strain is a 200,000th of the last: its work is at most 150 MPa x 0.15e-6, a hundred-thousandth of the toughness.
  for (const double stress : {104e6, 118e6, 131e6, 149e6}) CHECK(std::abs(c.damage_at(stress) - plain_damage(stress)) < 1e-5);
  double before = 0.0;
  for (double stress = 1e6; stress < 150e6; stress += 1e6) CHECK(c.damage_at(stress) >= std::exchange(before, c.damage_at(stress)));
  CHECK(before < 1.0);  // the work of the falling line is missing: at the strength the material breaks at once
}

TEST_CASE("stress-strain: a curve that is none is refused") {
  CHECK_FALSE(StressStrainCurve::create({{0.005, 100e6}}));
  CHECK_FALSE(StressStrainCurve::create({{0.005, 100e6}, {0.005, 110e6}}));
  CHECK_FALSE(StressStrainCurve::create({{0.005, 100e6}, {0.02, 0.0}}));
  CHECK_FALSE(StressStrainCurve::create({{0.005, 100e6}, {0.006, 130e6}}));  // steeper than elastic
  CHECK_FALSE(StressStrainCurve::create({{0.005, 100e6}, {std::nan(""), 110e6}}));
  CHECK(StressStrainCurve().strength() == 133e6);
}

TEST_CASE("progressive: the level of work against bisection, and no taker gets more than it can hold") {
  Random random{7};
  for (int n = 0; n < 200; ++n) {
    std::vector<WorkTaker> takers;
    double all = 0.0;
    for (std::size_t at = 0; at < 40; ++at) {
      takers.push_back({at, random.uniform(0.1, 1.0), random.uniform(0.0, 2.0)});
      all += takers.back().capacity;
    }
    const double work = random.uniform(0.0, 1.2) * all;
    const auto taken = [&](double level) {
      double sum = 0.0;
      for (const WorkTaker& taker : takers) sum += std::min(taker.capacity, level * taker.weight);
      return sum;
    };
    const double level = level_of_work(takers, work);
    CHECK(std::abs(taken(level) - std::min(work, all)) < 1e-12 * all);
    CHECK(taken(0.999 * level) < std::min(work, all));  // sabotage: a lower level leaves work over
  }
}

TEST_CASE("progressive: the removed bone has taken the work of cutting, and no more") {
  const double force = force_for(160e6);
  for (const float hardness : {1.0f, 0.5f}) {
    Voxmap bone = plane(hardness);
    Erosion erosion = make_erosion(ball_points(), law());
    const Affine pose = pressed();
    const double spin = 15.0, dt = 1e-3;
    const ErosionOutcome out = erosion.step(bone, {pose, pose}, {.spin = spin, .force = force}, dt);
    const double work = kMu * force * 2.0 * kPi * spin * out.rubbing_radius * dt;
    // Floats hold the bone left to 6e-8 a voxel, and a voxel takes a share of some thousandths.
    CHECK(std::abs(out.energy - work) < 1e-4 * work);
    CHECK(std::abs(out.removed_mass * kToughness / kWorkShare * static_cast<double>(hardness) - work) < 1e-4 * work);
    CHECK(std::abs(missing_mass(bone) - out.removed_mass) < 1e-9 * out.removed_mass);
    // Sabotage: work that deforms bone alone, without the share of friction, is another.
    CHECK(std::abs(out.removed_mass * kToughness * static_cast<double>(hardness) - work) > 0.5 * work);
  }
}

TEST_CASE("progressive: a stress below the strength damages bone to where it gets on the curve, and not further") {
  for (const double stress : {90e6, 110e6, 130e6, 145e6, 155e6}) {
    Voxmap bone = plane();
    Erosion erosion = make_erosion(ball_points(), law());
    const Affine pose = pressed();
    const double limit = plain_damage(stress);
    for (int n = 0; n < 40; ++n) {  // uncommitted, so that the stress stays as it is
      const ErosionOutcome out = erosion.step(bone, {pose, pose}, {.spin = 1000.0, .force = force_for(stress)}, 0.1);
      if (n == 39) CHECK(out.touched == 0);
    }
    double worst = 0.0;
    std::uint64_t damaged = 0;
    const MasterWindow& window = bone.window();
    for (const float left : window.remaining) {
      if (left == 1.0f) continue;
      ++damaged;
      worst = std::max(worst, std::abs(1.0 - static_cast<double>(left) - limit));
    }
    CHECK(worst < 2e-5);  // the plain sum's own error, and a float's
    CHECK((damaged > 0) == (stress > 100e6));
  }
}

TEST_CASE("progressive: steps of 2 to 100 ms remove the same, and nothing goes without spin, force, time or contact") {
  // Fixed in place and far from the limit: half of the work that the ball holds.
  const double force = force_for(160e6), spin = 2.0;
  double first = 0.0;
  for (const int steps : {1, 2, 10, 50}) {
    Voxmap bone = plane();
    Erosion erosion = make_erosion(ball_points(), law());
    const Affine pose = pressed();
    double mass = 0.0;
    for (int n = 0; n < steps; ++n) mass += erosion.step(bone, {pose, pose}, {.spin = spin, .force = force}, 0.1 / steps).removed_mass;
    if (steps == 1) first = mass;
    CHECK(std::abs(mass - first) < 1e-4 * first);
    CHECK(mass > 0.0);
  }
  Voxmap bone = plane();
  Erosion erosion = make_erosion(ball_points(), law());
  const Affine pose = pressed(), above = upright_pose(kEdge, Vec3(31.0, 32.0, 60.0));
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 0.0, .force = force}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 15.0, .force = 0.0}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 15.0, .force = std::nan("")}, 1e-3).touched == 0);
  CHECK(erosion.step(bone, {pose, pose}, {.spin = 15.0, .force = force}, 0.0).touched == 0);
  CHECK(erosion.step(bone, {above, above}, {.spin = 15.0, .force = 1e9}, 1e-3).touched == 0);
  CHECK(missing_mass(bone) == 0.0);
  // All that the ball holds goes in one step that has more work than it takes.
  const ErosionOutcome all = erosion.step(bone, {pose, pose}, {.spin = 1e9, .force = force}, 1.0);
  for (const float left : bone.window().remaining) CHECK((left == 1.0f || left == 0.0f));
  CHECK(all.energy < kMu * force * 2.0 * kPi * 1e9 * all.rubbing_radius);
}

TEST_CASE("progressive: bone, work and account stay sound in bone at random") {
  Voxmap bone = random_block(Vec3i(48), kEdge, 3);
  Erosion erosion = make_erosion(ball_points(), law());
  Random random{11};
  double mass = 0.0;
  for (int n = 0; n < 60; ++n) {
    const Affine from = turned_pose(kEdge, Vec3(random.uniform(0.0, 48.0), random.uniform(0.0, 48.0), random.uniform(0.0, 48.0)), 100 + n);
    const ErosionOutcome out =
        erosion.step(bone, {from, moved(from, Vec3(1.0, 0.5, 0.0))},
                     {.spin = random.uniform(0.0, 1e5), .force = random.uniform(0.0, 300.0)}, random.uniform(1e-3, 0.1));
    CHECK(std::isfinite(out.energy));
    CHECK(out.removed_mass >= 0.0);
    mass += out.removed_mass;
    bone.commit(out.changed);
  }
  for (const float left : bone.window().remaining) CHECK((left >= 0.0f && left <= 1.0f));
  CHECK(mass > 0.0);
  CHECK(std::abs(missing_mass(bone) - mass) < 1e-6 * mass);
}
