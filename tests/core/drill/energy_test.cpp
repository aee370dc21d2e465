#include "core/drill/energy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "tests/core/drill/subvoxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

double apart(double a, double b) { return std::abs(a - b) / (0.5 * (a + b)); }

/// A cylinder pressed sideways and down through bone it cannot clear: unsaturated.
struct Cut {
  double voxel = 0.25e-3, relative_pitch = 0.5;  ///< [m], [voxels]
  double rate = 1000.0, duration = 0.1;          ///< [1/s], [s]
  CuttingLoad load{.spin = 1000.0 / 60.0, .force = 160.0};
  float hardness = 1.0f;
  bool subvoxel = false;
};
struct CutResult {
  double removal = 0.0;  ///< Q [m^3/s]
  double left = 0.0;     ///< share of the swept bone
  double energy = 0.0;   ///< [J]
  double radius = 0.0;   ///< [m] mean of rubbing_radius
};

constexpr EnergyConfig kEnergy{.specific_energy = 1e8, .cutting_ratio = 0.5};

SweptSolid solid_of(const Cut& cut) {
  SweptSolid solid{.ball = false, .radius = 1.5e-3, .height = 2.5e-3, .voxel = cut.voxel, .way = Vec3(0.4e-3, 0.3e-3, -0.5e-3) / cut.voxel};
  solid.from = turned_pose(cut.voxel, Vec3(4.4e-3, 4.3e-3, 3.3e-3) / cut.voxel, 2);
  return solid;
}

/// Takes one step of a path: the law, or a twin that breaks it.
using StepFunction = std::function<ErosionOutcome(Voxmap&, Erosion&, const ErosionPath&, const CuttingLoad&, double)>;

ErosionOutcome the_law(Voxmap& voxmap, Erosion& erosion, const ErosionPath& path, const CuttingLoad& load, double dt) {
  return erosion.step(voxmap, path, load, dt);
}

CutResult run(const Cut& cut, const StepFunction& step = the_law) {
  const SweptSolid solid = solid_of(cut);
  Voxmap voxmap =
      Block{.dims = Vec3i(static_cast<int>(std::lround(9e-3 / cut.voxel))), .pitch = cut.voxel, .hardness = cut.hardness}.make();
  auto erosion = Erosion::create({.law = ErosionLaw::energy, .subvoxel = cut.subvoxel, .energy = kEnergy},
                                 solid.points(cut.relative_pitch * cut.voxel, 1.0f), field_of(solid, 1.0f));
  REQUIRE(erosion.ok());
  const int steps = static_cast<int>(std::lround(cut.duration * cut.rate));
  CutResult result;
  double mass = 0.0;
  for (int n = 0; n < steps; ++n) {
    const auto at = [&](int k) { return moved(solid.from, solid.way * (static_cast<double>(k) / steps)); };
    const ErosionOutcome outcome = step(voxmap, *erosion, {at(n), at(n + 1)}, cut.load, cut.duration / steps);
    voxmap.commit(outcome.changed);
    mass += outcome.removed_mass;
    result.energy += outcome.energy;
    result.radius += outcome.rubbing_radius / steps;
    CHECK(outcome.outside == 0);
  }
  CHECK(std::abs(missing_mass(voxmap) - mass) <= 1e-9 * std::max(mass, 1e-11));
  result.removal = mass / cut.duration;
  result.left = 1.0 - mass / (solid.volume() * std::pow(cut.voxel, 3.0));
  return result;
}

/// The sabotage: 40 voxels a step, the nearest to the window's corner that hold bone and that the tool's middle pose covers.
ErosionOutcome fixed_count(Voxmap& voxmap, Erosion&, const ErosionPath& path, const CuttingLoad&, double) {
  ErosionOutcome outcome;
  const MasterWindow& window = voxmap.window();
  TileMarks marks;
  marks.reset(window.box);
  const Affine tool = path.from.inverse();
  int taken = 0;
  for_each_voxel(window.erodible_box(), [&](const Vec3i& v) {
    float& left = voxmap.remaining()[window.box.offset_of(v)];
    if (taken == 40 || left == 0.0f || window.occupancy[window.box.offset_of(v)] == 0.0f) return;
    if (!Cylinder{1.5e-3, 2.5e-3}.holds(tool * Vec3(v))) return;
    outcome.removed_mass += static_cast<double>(left) * voxmap.bone().bone_from_index().cell_volume();
    left = 0.0f;
    const Vec3i at = v - window.box.lo;
    marks.mark({at.x & ~7, at.y, at.z}, 1u << (at.x & 7));
    ++taken;
  });
  outcome.changed = marks.boxes();
  return outcome;
}

/// Relative spread of Q over runs that must agree.
double over_rates(const StepFunction& step) {
  std::array<double, 3> q{};
  const std::array<double, 3> rates{500.0, 1000.0, 2000.0};
  for (std::size_t n = 0; n < 3; ++n) q[n] = run({.rate = rates[n]}, step).removal;
  return std::max(apart(q[0], q[1]), apart(q[2], q[1]));
}
double over_voxels(const StepFunction& step) { return apart(run({.voxel = 0.5e-3}, step).removal, run({}, step).removal); }

}  // namespace

// Sub-voxel removal recedes from a face, which a tool inside bone does not have: cut_face_test.cpp has its runs from outside.
TEST_CASE("energy: the run of these tests is unsaturated, and Q = mu F v_rel / u with the radius that the law reports") {
  const CutResult result = run({});
  CHECK(result.left > 0.2);
  CHECK(result.left < 0.8);
  const double expected = 0.5 * 160.0 * 2.0 * std::numbers::pi * (1000.0 / 60.0) * result.radius / 1e8;
  MESSAGE("Q " << result.removal * 1e9 << " mm3/s, expected " << expected * 1e9 << ", left " << result.left << ", radius "
               << result.radius * 1e3 << " mm");
  CHECK(apart(result.removal, expected) < 0.005);  // what the minimum density clears ahead in the last step
  CHECK(result.energy == doctest::Approx(result.removal * 0.1 * 1e8).epsilon(1e-6));
  CHECK(std::abs(result.radius - 1e-3) < 0.06e-3);  // 2 R / 3 of an even disc; the engaged part of it
}

TEST_CASE("energy: the same Q at 500, 1000 and 2000 Hz within 2 %, at two voxel pitches and two point pitches within 5 %") {
  const double rates = over_rates(the_law), voxels = over_voxels(the_law);
  const double points = apart(run({}).removal, run({.relative_pitch = 0.25}).removal);
  MESSAGE("Q apart by " << 100.0 * rates << " % over rates, " << 100.0 * voxels << " % over voxels, " << 100.0 * points
                        << " % over points");
  CHECK(rates < 0.02);
  CHECK(voxels < 0.05);
  CHECK(points < 0.05);
}

TEST_CASE("energy: a fixed count of voxels a step is the sabotage and fails the same bars") {
  CHECK(over_rates(fixed_count) > 0.02);
  CHECK(over_voxels(fixed_count) > 0.05);
  const double soft = run({.load = {.spin = 16.0, .force = 10.0}}, fixed_count).removal;
  CHECK(apart(soft, run({.load = {.spin = 16.0, .force = 40.0}}, fixed_count).removal) < 0.01);  // blind to force
}

TEST_CASE("energy: Q goes with the force and with the spin, and against hardness") {
  const double whole = run({}).removal;
  // The radius moves a little with where bone is left.
  CHECK(apart(2.0 * run({.load = {.spin = 1000.0 / 60.0, .force = 80.0}}).removal, whole) < 0.02);
  CHECK(apart(2.0 * run({.load = {.spin = 500.0 / 60.0, .force = 160.0}}).removal, whole) < 0.02);
  CHECK(apart(run({.load = {.spin = 1000.0 / 60.0, .force = 80.0}, .hardness = 0.5f}).removal, whole) < 0.02);
  CHECK(apart(run({.load = {.spin = 1000.0 / 60.0, .force = 16.0}, .hardness = 0.1f}).removal, whole) < 0.02);
}

TEST_CASE("energy: Q = 0 without force, without spin, without time, and for forces that are no number") {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const bool subvoxel : {false, true})
    for (const CuttingLoad& load : {CuttingLoad{16.0, 0.0}, {0.0, 40.0}, {16.0, -3.0}, {16.0, nan}, {nan, 40.0}, {16.0, inf}, {16.0}}) {
      const CutResult result = run({.rate = 100.0, .load = load, .subvoxel = subvoxel});
      CHECK(result.removal == 0.0);
      CHECK(result.energy == 0.0);
    }
}

TEST_CASE("energy: work beyond all the bone there is takes that bone and no more") {
  const CutResult result = run({.load = {.spin = 16.0, .force = 1e9}});
  // Every cell that a point lies in goes: more than the swept solid, by less than the shell of half a cell's diagonal round it.
  CHECK(result.left < 0.0);
  const double r = 1.5 + 0.217, h = 2.5 + 0.433;  // [mm]
  const double swept = solid_of({}).volume() * std::pow(0.25, 3.0), hull = swept * (r * r * h) / (1.5 * 1.5 * 2.5);
  CHECK(-result.left < hull / swept - 1.0);
  CHECK(result.energy == doctest::Approx(result.removal * 0.1 * 1e8).epsilon(1e-9));
}

TEST_CASE("energy: the turns solve their equation and compose") {
  std::vector<EnergyTerm> terms;
  for (int n = 1; n <= 50; ++n) terms.push_back({.worth = 1.0 / n, .rate = 0.01 * n * n});
  double worth = 0.0;
  for (const EnergyTerm& term : terms) worth += term.worth;
  for (const double part : {1e-9, 1e-3, 0.3, 0.9, 0.999999}) {
    const double k = turns_for_work(terms, part * worth);
    double spent = 0.0;
    for (const EnergyTerm& term : terms) spent += term.worth * -std::expm1(-k * term.rate);
    CHECK(std::abs(spent / (part * worth) - 1.0) < 1e-7);  // 1 - exp cancels where part is 1e-9
  }
  const double once = turns_for_work(terms, 0.4 * worth), first = turns_for_work(terms, 0.15 * worth);
  for (EnergyTerm& term : terms) term.worth *= std::exp(-first * term.rate);
  CHECK(std::abs(first + turns_for_work(terms, 0.25 * worth) - once) < 1e-9 * once);
  CHECK(turns_for_work(terms, 0.0) == 0.0);
  CHECK(turns_for_work(terms, -1.0) == 0.0);
  CHECK(turns_for_work(terms, 2.0 * worth) == std::numeric_limits<double>::infinity());
  CHECK(turns_for_work({}, 1.0) == std::numeric_limits<double>::infinity());
}
