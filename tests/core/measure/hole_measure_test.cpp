// The hole of a run is measured right where its closed form is known: cylinders cleared by hand in a plate.

#include "core/measure/hole_measure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "tests/app/run/cleared_plate.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kEdge = ClearedPlate::kPitch;
/// Half a voxel behind a face occupancy has come to 0.75 only, so that occupancy times remaining is 0.5 where remaining is 2/3: a sixth of
/// a voxel further out than the wall.
constexpr double kWider = kEdge / 3.0;

TEST_CASE("hole: a cylinder through a plate has its diameters and its volume") {
  for (const double radius : {1.1e-3, 1.5e-3}) {
    ClearedPlate plate;
    plate.clear(radius, 10e-3);
    const HoleMeasure hole = measure_hole(*plate.voxmap, plate.approach);
    REQUIRE(hole.outer_diameter.has_value());
    REQUIRE(hole.inner_diameter.has_value());
    const double volume = std::numbers::pi * radius * radius * ClearedPlate::kThickness;
    MESSAGE("diameters " << *hole.outer_diameter * 1e3 << " and " << *hole.inner_diameter * 1e3 << " mm of " << 2e3 * radius << ", volume "
                         << hole.removed * 1e9 << " of " << volume * 1e9 << " mm3");
    // A quarter voxel: rays half a voxel apart count cells, and trilinear corners round a circle of six voxels and more.
    CHECK(std::abs(*hole.outer_diameter - 2.0 * radius - kWider) < 0.25 * kEdge);
    CHECK(std::abs(*hole.inner_diameter - 2.0 * radius - kWider) < 0.25 * kEdge);
    // At t voxels s behind a face occupancy is (1 + t) / 2 up to t = 1, so the wall is 1 / (1 + t) - 1/2 of a voxel further out: s^2 (ln 2 - 1/2)
    // of area round the rim of each face. And a ramp on the grid, interpolated along two axes, moves a wall of radius r by up to s^2 / (8 r).
    const double wider = 4.0 * (std::numbers::ln2 - 0.5) * kEdge * kEdge / (radius * ClearedPlate::kThickness),
                 bent = 0.25 * std::pow(kEdge / radius, 2);
    CHECK(std::abs(hole.removed / volume - 1.0) < wider + bent);
  }
}

TEST_CASE("hole: a step has an outer and an inner diameter; a blind hole has no inner one") {
  ClearedPlate stepped;
  stepped.clear(2.0e-3, 1.5e-3);
  stepped.clear(1.25e-3, 10e-3);
  const HoleMeasure step = measure_hole(*stepped.voxmap, stepped.approach);
  REQUIRE(step.outer_diameter.has_value());
  REQUIRE(step.inner_diameter.has_value());
  CHECK(std::abs(*step.outer_diameter - 4.0e-3 - kWider) < 0.25 * kEdge);
  CHECK(std::abs(*step.inner_diameter - 2.5e-3 - kWider) < 0.25 * kEdge);

  ClearedPlate blind;
  blind.clear(1.0e-3, 1.5e-3);
  const HoleMeasure hole = measure_hole(*blind.voxmap, blind.approach);
  CHECK(hole.outer_diameter.has_value());
  CHECK_FALSE(hole.inner_diameter.has_value());
}

TEST_CASE("hole: what was drilled before the run is no part of it") {
  const TemporaryFolder folder;
  constexpr double kInner = 1.0e-3, kOuter = 2.0e-3;
  ClearedPlate first;
  first.clear(kInner, 10e-3);
  const double before = measure_hole(*first.voxmap, first.approach).removed_mass;
  REQUIRE(first.voxmap->save(folder.file("bone.vdb")));

  ClearedPlate second;
  REQUIRE(second.voxmap->restore(folder.file("bone.vdb")));
  CHECK(second.voxmap->starts_drilled());
  const HoleMeasure nothing = measure_hole(*second.voxmap, second.approach);
  CHECK(nothing.removed == 0.0);
  CHECK(nothing.removed_mass == 0.0);
  CHECK_FALSE(nothing.outer_diameter.has_value());
  second.clear(kOuter, 10e-3);
  const HoleMeasure ring = measure_hole(*second.voxmap, second.approach);
  ClearedPlate whole;
  whole.clear(kOuter, 10e-3);
  // Conservation: the mass of both runs is that of the wide hole in one go; sums of float products in double precision.
  CHECK(before + ring.removed_mass == doctest::Approx(measure_hole(*whole.voxmap, whole.approach).removed_mass).epsilon(1e-6));
  // The hole in the outer face is the ring, whose circle of the same area has the diameter 2 sqrt(R^2 - r^2). Both walls lie kWider / 2
  // further out; half a voxel of the inner one is ramp.
  REQUIRE(ring.outer_diameter.has_value());
  const double outer = kOuter + 0.5 * kWider, inner = kInner + 0.5 * kWider;
  CHECK(std::abs(*ring.outer_diameter - 2.0 * std::sqrt(outer * outer - inner * inner)) < 0.5 * kEdge);
}

TEST_CASE("hole: untouched bone has none") {
  ClearedPlate plate;
  const HoleMeasure hole = measure_hole(*plate.voxmap, plate.approach);
  CHECK(hole.removed == 0.0);
  CHECK_FALSE(hole.outer_diameter.has_value());
  CHECK_FALSE(hole.inner_diameter.has_value());
}

}  // namespace
}  // namespace burrhole::test
