#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "core/drill/coverage.h"
#include "tests/core/drill/coverage_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kVoxel = 0.25e-3;

double apart(double a, double b) { return std::abs(a - b) / (0.5 * (a + b)); }

struct Run {
  double voxel = kVoxel, rate = 1000.0, duration = 0.1, lambda = 16.0;
};
struct Passed {
  double mass = 0.0, left = 0.0;
};

/// A ball of 1.5 mm once through a block, unsaturated.
Passed pass(const Run& run) {
  SweptSolid solid{.ball = true, .radius = 1.5e-3, .voxel = run.voxel, .way = Vec3(2.1e-3, 1.3e-3, 1.9e-3) / run.voxel};
  const int edge = static_cast<int>(std::lround(9e-3 / run.voxel));
  solid.from = turned_pose(run.voxel, Vec3(0.5 * (edge - 1)) - 1.7e-3 / run.voxel, 4);
  Voxmap voxmap = Block{.dims = Vec3i(edge), .pitch = run.voxel}.make();
  Erosion erosion = subvoxel_erosion(solid, 1.0f);
  const Drilling done =
      drill(voxmap, erosion, solid.path(), run.lambda, run.duration, static_cast<int>(std::lround(run.duration * run.rate)));
  CHECK(done.outside == 0);
  return {done.mass, 1.0 - done.mass / (solid.volume() * std::pow(run.voxel, 3.0))};
}

/// A ball of 6 voxels in the middle of a block, turned.
SweptSolid resting_ball(double radius = 6.0) { return random_solid({.ball = true, .radius = radius, .way = 0.0, .seed = 5}); }

/// Removed volume [voxels^3] after as many sub-steps at rest, when each takes its share of coverage from what is left: the product.
double by_product(const SweptSolid& solid, const Coverage& coverage, const VoxelBox& box, int substeps) {
  double removed = 0.0;
  for_each_voxel(box, [&](const Vec3i& v) { removed += 1.0 - std::pow(1.0 - coverage.covered(v), substeps); });
  return removed / solid.volume();
}

}  // namespace

TEST_CASE("coverage: overlapping sub-steps take the union, a product of shares does not") {
  const SolidCase one{.ball = true, .radius = 3.0, .way = 0.0, .seed = 5};
  const SweptSolid solid = random_solid(one);
  Voxmap voxmap = block_for(one);
  Erosion erosion = subvoxel_erosion(solid, kAtOnce);
  double sum = 0.0;
  for (int n = 0; n < 40; ++n) {
    const double removed = sweep_through(voxmap, erosion, solid, 1);
    if (n > 0) CHECK(removed == 0.0);  // at rest nothing new is covered
    sum += removed;
  }
  CHECK(std::abs(sum / solid.volume() - 1.0) < 0.03);
  Coverage coverage(field_of(solid, kAtOnce), CoverageKernel::trapezoid);
  std::vector<Engaged> engaged;
  Voxmap fresh = block_for(one);
  (void)coverage.advance(fresh, solid.path(), engaged);
  CHECK(std::abs(by_product(solid, coverage, fresh.window().box, 1) - 1.0) < 0.03);
  CHECK(by_product(solid, coverage, fresh.window().box, 40) > 1.3);
}

TEST_CASE("coverage: two tools' halves of a voxel add up, and where they meet nothing stands") {
  // A cylinder's flat end comes from below to z = 10.3 and from above to the same place: together they clear all between.
  Voxmap voxmap = Block{.dims = Vec3i(30), .pitch = kVoxel}.make();
  SweptSolid solid{.ball = false, .radius = 4.0 * kVoxel, .height = 6.0 * kVoxel, .voxel = kVoxel};
  Erosion erosion = subvoxel_erosion(solid, kAtOnce);
  const Affine upper = upright_pose(kVoxel, Vec3(14.2, 13.9, 10.3));
  Affine lower = upper;
  lower.linear[1] = -lower.linear[1];
  lower.linear[2] = -lower.linear[2];
  for (const Affine& pose : {upper, lower}) voxmap.commit(erosion.step(voxmap, {pose, pose}, 1.0, 1e-3).changed);
  const MasterWindow& window = voxmap.window();
  for (int z = 6; z <= 14; ++z) CHECK(window.remaining[window.box.offset_of({14, 14, z})] == 0.0f);
}

TEST_CASE("coverage: remaining never falls below 1 - covered, whatever the rate, and never rises") {
  const SolidCase one{.ball = false, .radius = 3.0, .way = 5.0, .seed = 9};
  const SweptSolid solid = random_solid(one);
  for (const double lambda : {5.0, 300.0, 1e9}) {
    Voxmap voxmap = block_for(one);
    Coverage coverage(field_of(solid, 1.0f), CoverageKernel::trapezoid);
    Erosion erosion = subvoxel_erosion(solid, 1.0f);
    std::vector<float> before = voxmap.window().remaining;
    std::vector<Engaged> engaged;
    int below = 0, risen = 0;
    for (int n = 0; n < 30; ++n) {
      const ErosionPath part{moved(solid.from, solid.way * (n / 30.0)), moved(solid.from, solid.way * ((n + 1) / 30.0))};
      (void)coverage.advance(voxmap, part, engaged);
      voxmap.commit(erosion.step(voxmap, part, lambda, 1e-3).changed);
      const MasterWindow& window = voxmap.window();
      for_each_voxel(window.box, [&](const Vec3i& v) {
        const float left = window.remaining[window.box.offset_of(v)];
        below += static_cast<double>(left) < 1.0 - coverage.covered(v) - 1e-6 ? 1 : 0;  // a few float roundings
        risen += left > before[window.box.offset_of(v)] ? 1 : 0;
      });
      before = window.remaining;
    }
    CHECK(below == 0);
    CHECK(risen == 0);
  }
}

TEST_CASE("coverage: an unsaturated run removes the same mass at 500, 1000, 2000 Hz within 2 % and at two voxel pitches within 5 %") {
  for (const double duration : {0.1, 0.02}) {
    const double lambda = 1.6 / duration;
    const Passed slow = pass({.rate = 500.0, .duration = duration, .lambda = lambda});
    const Passed middle = pass({.duration = duration, .lambda = lambda});
    const Passed fast = pass({.rate = 2000.0, .duration = duration, .lambda = lambda});
    MESSAGE(duration << " s: " << slow.mass * 1e9 << ", " << middle.mass * 1e9 << ", " << fast.mass * 1e9 << " mm3, left " << middle.left);
    CHECK(middle.left > 0.2);
    CHECK(middle.left < 0.8);
    CHECK(apart(slow.mass, middle.mass) < 0.02);
    CHECK(apart(fast.mass, middle.mass) < 0.02);
  }
  const Passed coarse = pass({.voxel = 0.5e-3}), fine = pass({});
  MESSAGE("0.5 and 0.25 mm: " << coarse.mass * 1e9 << " and " << fine.mass * 1e9 << " mm3");
  CHECK(apart(coarse.mass, fine.mass) < 0.05);
}

TEST_CASE("coverage: skipping inactive voxels marks what visiting every voxel marks: steps, jumps, turns and pauses") {
  // A tool that knows no step before looks at every voxel. So does one whose last pose lies far off, since nothing sleeps that long: a step
  // there and back in between wakes all. It stands in air outside the block, where it marks nothing.
  for (const bool ball : {true, false}) {
    const SolidCase one{.ball = ball, .radius = 4.0, .way = 4.0, .seed = 12};
    const SweptSolid solid = random_solid(one);
    const Voxmap voxmap = block_for(one);
    Coverage sleeping(field_of(solid, 1.0f), CoverageKernel::trapezoid), awake(field_of(solid, 1.0f), CoverageKernel::trapezoid);
    std::vector<Engaged> a, b;
    Affine from = solid.from;
    std::size_t compared = 0;
    for (std::uint64_t n = 0; n < 120; ++n) {
      const auto u = [&](std::uint64_t m) { return uniform11(77, 16 * n + m); };
      // Small steps, some none, each tenth one of half a voxel, and now and then a jump between steps.
      const double size = n % 10 == 9 ? 0.5 : n % 4 == 0 ? 0.0 : 0.01;
      if (n % 17 == 16) from = moved(from, Vec3(u(3), u(4), u(5)));
      Affine to = moved(from, size * Vec3(u(0), u(1), u(2)));
      const Vec3 middle = to * Vec3(0.0, 0.0, solid.radius);
      const Mat3 turn = glm::mat3_cast(glm::angleAxis(0.02 * size * u(6), glm::normalize(Vec3(u(7), u(8), 1.0))));
      to.linear = turn * to.linear;
      to.offset += middle - to * Vec3(0.0, 0.0, solid.radius);
      a.clear();
      b.clear();
      (void)sleeping.advance(voxmap, {from, to}, a);
      const Affine far = moved(from, Vec3(1000.0, 0.0, 0.0));
      std::vector<Engaged> none;
      (void)awake.advance(voxmap, {far, far}, none);
      CHECK(none.empty());
      (void)awake.advance(voxmap, {from, to}, b);
      REQUIRE(a.size() == b.size());
      for (std::size_t m = 0; m < a.size(); ++m) {
        REQUIRE(a[m].at == b[m].at);
        REQUIRE(a[m].share == b[m].share);
        REQUIRE(a[m].exposure == b[m].exposure);
      }
      compared += a.size();
      from = to;
    }
    CHECK(compared > 10000);
  }
}

TEST_CASE("coverage: a window that slides away and back keeps what was covered") {
  const SweptSolid solid = resting_ball();
  const SolidCase one{.radius = 6.0, .way = 0.0};
  Voxmap still = block_for(one), slid = block_for(one);
  Erosion a = subvoxel_erosion(solid, 1.0f), b = subvoxel_erosion(solid, 1.0f);
  const VoxelBox box = slid.window().box;
  for (int n = 0; n < 6; ++n) {
    const Affine pose = moved(solid.from, Vec3(0.3 * n, -0.2 * n, 0.1 * n));
    still.commit(a.step(still, {pose, pose}, 200.0, 1e-3).changed);
    slid.commit(b.step(slid, {pose, pose}, 200.0, 1e-3).changed);
    REQUIRE(slid.place_window({box.lo + 3, box.hi + n}).ok());
    REQUIRE(slid.place_window({box.lo - n, box.hi + 1}).ok());
  }
  CHECK(still.hash() == slid.hash());
}

TEST_CASE("coverage: after a restore drilling goes on as if nothing had happened, within the plane put through each voxel") {
  const SolidCase one{.ball = true, .radius = 6.0, .way = 6.0, .seed = 3};
  const SweptSolid solid = random_solid(one);
  const std::string file = "coverage_restore_test.vdb";
  Voxmap whole = block_for(one), stopped = block_for(one);
  const ErosionPath first{solid.from, moved(solid.from, 0.5 * solid.way)}, second{first.to, solid.path().to};
  Erosion a = subvoxel_erosion(solid, kAtOnce), b = subvoxel_erosion(solid, kAtOnce);
  for (auto [voxmap, erosion] : {std::pair(&whole, &a), std::pair(&stopped, &b)}) (void)drill(*voxmap, *erosion, first, 1.0, 0.02, 20);
  REQUIRE(stopped.save(file).ok());
  REQUIRE(stopped.restore(file).ok());
  CHECK(std::remove(file.c_str()) == 0);
  double mass = 0.0;
  for (auto [voxmap, erosion] : {std::pair(&whole, &a), std::pair(&stopped, &b)})
    mass = drill(*voxmap, *erosion, second, 1.0, 0.02, 20).mass;
  double worst = 0.0, sum = 0.0, samples = 0.0;
  for (std::size_t n = 0; n < whole.window().remaining.size(); ++n) {
    const double d = std::abs(static_cast<double>(whole.window().remaining[n]) - static_cast<double>(stopped.window().remaining[n]));
    worst = std::max(worst, d);
    sum += d;
    samples += d > 0.0 ? 1.0 : 0.0;
  }
  MESSAGE("after a restore: " << samples << " voxels differ, by " << sum / std::max(1.0, samples) << " on average, at worst " << worst);
  CHECK(worst < 0.15);  // two planes through one voxel, each off by what 64 samples tell
  CHECK(std::abs(missing_mass(whole) / missing_mass(stopped) - 1.0) < 0.01);
  CHECK(mass > 0.0);
}

TEST_CASE("coverage: create asks for a field and a law that fits") {
  const SweptSolid solid = resting_ball();
  const ErosionPoints points = solid.points(0.5 * kVoxel, 1.0f);
  CHECK_FALSE(Erosion::create({.subvoxel = true}, points).ok());
  CHECK_FALSE(Erosion::create({.law = ErosionLaw::per_update, .subvoxel = true}, points, field_of(solid, 1.0f)).ok());
  CHECK(Erosion::create({.subvoxel = true}, points, field_of(solid, 1.0f)).ok());
  CHECK_FALSE(Erosion::create({.law = ErosionLaw::energy, .energy = {.specific_energy = 0.0}}, points).ok());
  CHECK_FALSE(Erosion::create({.law = ErosionLaw::energy, .energy = {.cutting_ratio = std::nan("")}}, points).ok());
}

TEST_CASE("coverage: voxels beyond the window are counted and left alone") {
  const SolidCase one{.radius = 5.0, .way = 0.0, .seed = 2};
  const SweptSolid solid = random_solid(one);
  Voxmap voxmap = block_for(one);
  REQUIRE(voxmap.place_window({Vec3i(0), Vec3i(static_cast<int>(0.5 * voxmap.bone().dims().x))}).ok());
  Erosion erosion = subvoxel_erosion(solid, kAtOnce);
  const ErosionOutcome outcome = erosion.step(voxmap, solid.path(), 1.0, 1e-3);
  CHECK(outcome.outside > 0);
  CHECK(voxmap.window().erodible_box().contains(outcome.changed.bounds()));
}
