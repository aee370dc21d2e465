// Figures of a heat field: the dose at a face and the volume that a dose kills, with bone that was put back and in coarse cells.
#include "core/heat/heat_figures.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/heat/thermal_dose.h"

using namespace burrhole;

namespace {

constexpr double kEdge = 1e-3, kCell = kEdge * kEdge * kEdge, kUnit = 1810.0 * 1250.0 * kCell;  // [m], [m^3], [J/K]
const Vec3i kUp(0, 0, 1);

/// A column of cells with air round it: no heat leaves it.
HeatField column(int cells, const HeatConfig& config = {}) {
  auto made = HeatField::create(config, Vec3(kEdge), {Vec3i(-1), Vec3i(2, 2, cells + 1)});
  REQUIRE(made.ok());
  HeatField field = std::move(made).value();
  const VoxelBox bone{Vec3i(0), Vec3i(1, 1, cells)};
  field.set_bone(bone, std::vector<float>(bone.count(), 1.0f));
  return field;
}

void put(HeatField& field, int cell, float share) {
  const VoxelBox box{Vec3i(0, 0, cell), Vec3i(1, 1, cell + 1)};
  field.set_bone(box, std::vector<float>{share});
  field.forget_losses();
}

}  // namespace

TEST_CASE("heat: the dose at a face is 0 if nothing was heated") {
  HeatField field = column(4);
  CHECK(dose_at_face(field, Vec3i(0), kUp) == 0.0);
  field.step(1.0);
  CHECK(dose_at_face(field, Vec3i(0), kUp) == 0.0);
}

TEST_CASE("heat: bone that is put back cold changes no dose at a face beside it, and makes no dead bone") {
  HeatField field = column(4);
  for (int n = 0; n < 4; ++n) field.release_at(Vec3i(0, 0, n), 10.0 * kUnit);  // 47 C for a minute: 16 min, below the limit
  field.step(60.0);
  const double dose = static_cast<double>(field.dose(Vec3i(0)));
  REQUIRE(dose == doctest::Approx(16.0).epsilon(1e-3));
  CHECK(dose_at_face(field, Vec3i(0), kUp) == doctest::Approx(dose).epsilon(1e-3));
  // Inside the face: the face keeps its dose. At the face: what was put back there was not heated.
  put(field, 1, 0.0f);
  CHECK(dose_at_face(field, Vec3i(0), kUp) == dose);
  put(field, 1, 1.0f);
  CHECK(field.dose(Vec3i(0, 0, 1)) == 0.0f);
  CHECK(dose_at_face(field, Vec3i(0), kUp) == dose);
  CHECK(dose_at_face(field, Vec3i(0, 0, 1), kUp) == 0.0);
  // Twice the dose is a kelvin away: no bone had it, and the cold cell is no slope.
  CHECK(volume_with_dose(field, 2.0 * dose) == 0.0);
  CHECK(volume_with_dose(field, 0.5 * dose) / kCell == doctest::Approx(3.0));
}

TEST_CASE("heat: in coarse cells of which the dose rises steeply, dead bone is found in a cell whose mean is far below the limit") {
  // 44, 45 and 99 C for a minute: of doses above a minute a level is a kelvin, so the slope in the middle is 55 / 2 levels a cell.
  HeatField field = column(3, {.conductivity = 1e-9});  // no heat flows
  const double rises[] = {7.0, 8.0, 62.0};
  for (int n = 0; n < 3; ++n) field.release_at(Vec3i(0, 0, n), rises[n] * kUnit);
  field.step(60.0);
  // The points of the sum lie at +-1/8 and +-3/8 of a cell: the limit of 54 C, 9 levels above the mean, is passed by the quarter at 3/8 alone.
  const double limit = thermal_dose(54.0, 60.0);
  REQUIRE(std::log2(limit / static_cast<double>(field.dose(Vec3i(0, 0, 1)))) == doctest::Approx(9.0).epsilon(1e-3));
  CHECK(volume_with_dose(field, limit) / kCell == doctest::Approx(1.25));
}
