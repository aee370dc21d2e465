#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "core/base/random.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPitch = 0.5e-3;

/// A small ball with a factor of its own at each point, in a random block, moved obliquely.
struct Case {
  std::uint64_t seed;
  Voxmap voxmap = random_block(Vec3i(20, 18, 16), kPitch, seed);
  ErosionPoints points = lattice(Ball{1.3e-3}, 0.25e-3, 0.0f);
  Affine from = turned_pose(kPitch, Vec3(8.0, 7.0, 5.0), seed);
  Affine to = moved(from, Vec3(2.31, 1.73, 2.11));

  explicit Case(std::uint64_t seed_) : seed(seed_) {
    for (std::size_t n = 0; n < points.size(); ++n) points.factors[n] = static_cast<float>(uniform01(seed + 90, n));
  }
  [[nodiscard]] ErosionPath part(int n, int steps) const {
    const Vec3 way = to.offset - from.offset;
    return {moved(from, way * (static_cast<double>(n) / steps)), moved(from, way * (static_cast<double>(n + 1) / steps))};
  }
};

}  // namespace

TEST_CASE("erosion rate: one step equals a slow plain twin within 1e-6, a flipped exponent or a missing share does not") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Case c(seed);
    PlainErosion twin(c.voxmap, c.points, {}), sabotaged(c.voxmap, c.points, {});
    Erosion erosion = make_erosion(c.points);
    const ErosionPath path = c.part(0, 1);
    const ErosionOutcome outcome = erosion.step(c.voxmap, path, 300.0, 1e-3);
    c.voxmap.commit(outcome.changed);
    REQUIRE(outcome.outside == 0);
    twin.step(path, static_cast<int>(outcome.substeps), 300.0, 1e-3);
    sabotaged.step(path, static_cast<int>(outcome.substeps), 303.0, 1e-3);  // one percent too fast
    REQUIRE(twin.on_a_face() == 0);
    const TwinComparison comparison = compare(c.voxmap, twin);
    MESSAGE("seed " << seed << ": " << outcome.substeps << " sub-steps, largest difference " << comparison.worst << ", at the threshold "
                    << comparison.at_threshold << ", cleared " << comparison.cleared);
    CHECK(comparison.worst < 1e-6);  // some eight float roundings, of exposure and remaining
    CHECK(comparison.differently_cleared <= comparison.at_threshold);
    CHECK(compare(c.voxmap, sabotaged).worst > 1e-6);
  }
}

TEST_CASE("erosion rate: 1000 steps equal a slow plain twin within 1e-4, voxels at the threshold aside") {
  for (std::uint64_t seed = 5; seed <= 6; ++seed) {
    CAPTURE(seed);
    Case c(seed);
    PlainErosion twin(c.voxmap, c.points, {});
    Erosion erosion = make_erosion(c.points);
    for (int n = 0; n < 1000; ++n) {
      const ErosionPath path = c.part(n, 1000);
      const ErosionOutcome outcome = erosion.step(c.voxmap, path, 8.0, 1e-3);
      c.voxmap.commit(outcome.changed);
      REQUIRE(outcome.substeps == 1);
      twin.step(path, 1, 8.0, 1e-3);
    }
    REQUIRE(twin.on_a_face() == 0);
    const TwinComparison comparison = compare(c.voxmap, twin);
    MESSAGE("seed " << seed << ": largest difference " << comparison.worst << ", at the threshold " << comparison.at_threshold
                    << ", cleared " << comparison.cleared << " of " << twin.cells().size());
    CHECK(comparison.worst < 1e-4);  // a thousand float roundings of 6e-8 at most
    CHECK(comparison.differently_cleared <= comparison.at_threshold);
    CHECK(comparison.at_threshold <= 3);
    CHECK(comparison.cleared > 20);
  }
}

TEST_CASE("erosion: removed mass is occupancy times the loss of remaining, before minus after, in both laws") {
  for (const ErosionLaw law : {ErosionLaw::rate, ErosionLaw::per_update}) {
    Case c(7);
    Erosion erosion = make_erosion(c.points, {.law = law});
    double removed = 0.0;
    for (int n = 0; n < 50; ++n) {
      const ErosionOutcome outcome = erosion.step(c.voxmap, c.part(n, 50), law == ErosionLaw::rate ? 100.0 : 0.05, 1e-3);
      c.voxmap.commit(outcome.changed);
      removed += outcome.removed_mass;
    }
    const double missing = missing_mass(c.voxmap);
    MESSAGE("removed " << removed * 1e9 << " mm3, missing " << missing * 1e9 << " mm3");
    CHECK(missing > 0.5e-9);
    // Differences of floats are exact in double; what is left is the rounding of sums of some 1e4 terms.
    CHECK(std::abs(removed - missing) < 1e-12 * missing * 1e2);
  }
}

TEST_CASE("erosion rate: the order of the points does not matter beyond float rounding") {
  Case c(8);
  std::vector<std::size_t> order(c.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t n = order.size() - 1; n > 0; --n)
    std::swap(order[n], order[static_cast<std::size_t>(uniform01(4, n) * static_cast<double>(n + 1))]);
  ErosionPoints shuffled = c.points;
  for (std::size_t n = 0; n < order.size(); ++n) {
    shuffled.positions[n] = c.points.positions[order[n]];
    shuffled.factors[n] = c.points.factors[order[n]];
  }
  Case other(8);
  Erosion erosion = make_erosion(c.points), mixed = make_erosion(shuffled);
  const ErosionOutcome a = erosion.step(c.voxmap, c.part(0, 1), 200.0, 1e-3), b = mixed.step(other.voxmap, c.part(0, 1), 200.0, 1e-3);
  CHECK(a.touched == b.touched);
  CHECK(a.changed == b.changed);
  double worst = 0.0;
  for (std::size_t n = 0; n < c.voxmap.window().remaining.size(); ++n)
    worst = std::max(
        worst, std::abs(static_cast<double>(c.voxmap.window().remaining[n]) - static_cast<double>(other.voxmap.window().remaining[n])));
  MESSAGE("largest difference of remaining after a shuffle " << worst);
  CHECK(worst < 1e-6);  // float sums of some eight factors in another order, a few sub-steps
  CHECK(std::abs(a.removed_mass - b.removed_mass) < 1e-6 * a.removed_mass);
}

TEST_CASE("erosion rate: at rest two half steps equal one step to float rounding") {
  Case whole(9), halves(9);
  Erosion erosion = make_erosion(whole.points);
  const ErosionPath rest{whole.from, whole.from};
  whole.voxmap.commit(erosion.step(whole.voxmap, rest, 60.0, 2e-3).changed);
  for (int n = 0; n < 2; ++n) halves.voxmap.commit(erosion.step(halves.voxmap, rest, 60.0, 1e-3).changed);
  double worst = 0.0;
  int changed = 0;
  for (std::size_t n = 0; n < whole.voxmap.window().remaining.size(); ++n) {
    const double a = static_cast<double>(whole.voxmap.window().remaining[n]), b = static_cast<double>(halves.voxmap.window().remaining[n]);
    changed += a < 1.0 ? 1 : 0;
    if (static_cast<double>(whole.voxmap.window().occupancy[n]) * std::max(a, b) < 0.0501) continue;  // at or below the threshold
    worst = std::max(worst, std::abs(a - b));
  }
  CHECK(changed > 50);
  // Not bit for bit: exp(-x/2) squared rounds once more to float than exp(-x) does.
  CHECK(worst <= 2 * 6e-8);
}

TEST_CASE("erosion rate: one step along a path equals two half steps along its halves, since sub-steps fall on the same places") {
  Case whole(10), halves(10);
  Erosion erosion = make_erosion(whole.points);
  REQUIRE(erosion.substeps_for(whole.part(0, 1)) == 2 * erosion.substeps_for(whole.part(0, 2)));
  whole.voxmap.commit(erosion.step(whole.voxmap, whole.part(0, 1), 60.0, 2e-3).changed);
  for (int n = 0; n < 2; ++n) halves.voxmap.commit(erosion.step(halves.voxmap, halves.part(n, 2), 60.0, 1e-3).changed);
  double worst = 0.0;
  for (std::size_t n = 0; n < whole.voxmap.window().remaining.size(); ++n)
    worst = std::max(worst, std::abs(static_cast<double>(whole.voxmap.window().remaining[n]) -
                                     static_cast<double>(halves.voxmap.window().remaining[n])));
  CHECK(missing_mass(whole.voxmap) > 0.5e-9);
  CHECK(worst < 1e-6);  // float roundings of about eight sub-steps
}
