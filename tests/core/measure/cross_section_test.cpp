// The cross-section of a bit against closed forms, and its cleared share on plates that were cleared by hand.

#include "core/measure/cross_section.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/app/run/cleared_plate.h"

namespace burrhole::test {
namespace {

constexpr double kPi = std::numbers::pi, kPitch = 0.125e-3;

/// Erosion points of a solid: those of the lattice for which `inside` holds.
ErosionPoints points_of(double reach, double height, const std::function<bool(double radius, double z)>& inside) {
  ErosionPoints out;
  out.pitch = kPitch;
  const int wide = static_cast<int>(reach / kPitch) + 1, high = static_cast<int>(height / kPitch) + 1;
  for (int k = 0; k < high; ++k)
    for (int j = -wide; j < wide; ++j)
      for (int i = -wide; i < wide; ++i) {
        const Vec3 p = (Vec3(i, j, k) + 0.5) * kPitch;
        if (!inside(std::hypot(p.x, p.y), p.z)) continue;
        out.positions.push_back(p);
        out.factors.push_back(0.2f);
      }
  return out;
}

ErosionPoints drill_of(double radius) {
  return points_of(radius, 4e-3, [=](double r, double z) { return r < radius && z < 4e-3; });
}

/// Area of a lattice figure: a cell is in or out by its centre, so a circle of radius r errs by less than a pitch on its circumference.
double area_error(double radius) { return 2.0 * kPi * radius * kPitch; }

TEST_CASE("cross-section: the inner drill of a perforator, up to the shoulder of the outer one") {
  const CrossSection section = leading_section(
      points_of(7e-3, 7e-3, [](double r, double z) { return z < 3e-3 ? r < 5.5e-3 - z * 0.2 / 3.0 : z < 7e-3 && r < 7e-3; }));
  CHECK(section.on_axis);
  CHECK(std::abs(section.radius - 5.5e-3) < kPitch);
  CHECK(std::abs(section.area() - kPi * 5.5e-3 * 5.5e-3) < area_error(5.5e-3));
}

TEST_CASE("cross-section: the whole of a ball, of a pointed drill and of a cylinder, the ring of a crown") {
  for (const double radius : {1e-3, 3e-3}) {
    const CrossSection ball =
        leading_section(points_of(radius, 2.0 * radius, [=](double r, double z) { return std::hypot(r, z - radius) < radius; }));
    CHECK(std::abs(ball.area() - kPi * radius * radius) < area_error(radius));
  }
  const CrossSection pointed =
      leading_section(points_of(1.25e-3, 1.25e-3, [](double r, double z) { return z < 1.251e-3 && r < std::min(1.25e-3, z * 1.664); }));
  CHECK(std::abs(pointed.radius - 1.25e-3) < kPitch);
  const CrossSection crown = leading_section(points_of(6e-3, 3e-3, [](double r, double z) { return z < 3e-3 && r > 5e-3 && r < 6e-3; }));
  CHECK_FALSE(crown.on_axis);
  CHECK(std::abs(crown.area() - kPi * 11e-6) < area_error(5e-3) + area_error(6e-3));
  CHECK(leading_section({}).cells.empty());
}

TEST_CASE("cross-section: the lowest point over a cell is that of the outline") {
  const CrossSection ball = leading_section(points_of(2e-3, 4e-3, [](double r, double z) { return std::hypot(r, z - 2e-3) < 2e-3; }));
  for (const SectionCell& cell : ball.cells) {
    const double r = std::hypot(cell.x, cell.y), outline = 2e-3 - std::sqrt(std::max(0.0, 4e-6 - r * r));
    CHECK(cell.lowest >= outline - 1e-9);
    CHECK(cell.lowest <= outline + kPitch + 1e-9);
  }
}

TEST_CASE("cross-section: a hole of r in a section of R clears (r / R)^2 of it") {
  constexpr double kRadius = 2e-3;
  const CrossSection section = leading_section(drill_of(kRadius));
  // A column counts by its middle, in a wall that is true to a quarter voxel (hole_measure_test): that much of the circumference.
  const auto error = [&](double r) { return 2.0 * kPi * r * (0.25 * ClearedPlate::kPitch + kPitch) / section.area(); };
  for (const double r : {1.0e-3, 1.5e-3}) {
    ClearedPlate plate;
    plate.clear(r, 10e-3);
    const auto measured = measure_section(*plate.voxmap, plate.approach, section, 4e-3);
    REQUIRE(measured.has_value());
    CHECK(std::abs(measured->cleared - (r / kRadius) * (r / kRadius)) < error(r));
    // The tip is a millimetre beyond the plate: all columns were passed, and what is not clear is uncut.
    REQUIRE(measured->uncut.has_value());
    CHECK(*measured->uncut == doctest::Approx(1.0 - measured->cleared));
  }
  ClearedPlate wide;
  wide.clear(2.5e-3, 10e-3);
  CHECK(measure_section(*wide.voxmap, wide.approach, section, 4e-3)->cleared == 1.0);
}

TEST_CASE("cross-section: a blind hole and whole bone clear none of it, and a tip in bone has passed none") {
  const CrossSection section = leading_section(drill_of(1.5e-3));
  ClearedPlate blind;
  blind.clear(2.5e-3, 2.5e-3);
  const auto measured = measure_section(*blind.voxmap, blind.approach, section, 2.5e-3);
  REQUIRE(measured.has_value());
  CHECK(measured->cleared == 0.0);
  CHECK_FALSE(measured->uncut.has_value());
  const ClearedPlate whole;
  CHECK(measure_section(*whole.voxmap, whole.approach, section, -1e-3)->cleared == 0.0);
}

TEST_CASE("cross-section: a crown through its ring has cleared all of it, and bone on the axis does not count") {
  const CrossSection ring = leading_section(points_of(3e-3, 3e-3, [](double r, double z) { return z < 3e-3 && r > 2e-3 && r < 3e-3; }));
  ClearedPlate plate;
  const MasterWindow& window = plate.voxmap->window();
  const VoxelBox box = window.erodible_box();
  for_each_voxel(box, [&](const Vec3i& v) {
    const Vec3 p = plate.bone->bone_from_index() * Vec3(v);
    const double r = std::hypot(p.x, p.y);
    if (r > 1.75e-3 && r < 3.25e-3) plate.voxmap->remaining()[window.box.offset_of(v)] = 0.0f;
  });
  plate.voxmap->commit(box);
  const auto measured = measure_section(*plate.voxmap, plate.approach, ring, 4e-3);
  REQUIRE(measured.has_value());
  CHECK(measured->cleared == 1.0);
  CHECK(measured->uncut == 0.0);
}

}  // namespace
}  // namespace burrhole::test
