#include <doctest/doctest.h>

#include <limits>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"

using namespace burrhole;

namespace {
// A few roundings of double arithmetic on angles of order 1.
constexpr double kRounding = 1e-12;
Affine grid(const Vec3& i, const Vec3& j, const Vec3& k) { return {Mat3(i, j, k) * kMillimetre, Vec3(0.01, 0.02, 0.03)}; }
}  // namespace

TEST_CASE("describe_grid: spacing and straight axes of a plain scan") {
  const GridShape shape = describe_grid(grid({0.45, 0, 0}, {0, 0.5, 0}, {0, 0, 1}));
  CHECK(std::abs(shape.spacing.x - 0.45e-3) < kRounding);
  CHECK(std::abs(shape.spacing.y - 0.5e-3) < kRounding);
  CHECK(shape.shear < kRounding);
  CHECK(shape.oblique < kRounding);
  CHECK_FALSE(shape.mirrored);
}

TEST_CASE("describe_grid: a gantry tilt of 12 degrees is a shear of 12 degrees, to the last digit of small ones") {
  for (const double degrees : {12.0, 1e-6}) {
    const double t = std::tan(degrees * kDegree);
    const GridShape shape = describe_grid(grid({0.5, 0, 0}, {0, 0.5, 0}, {0, 1.25 * t, 1.25}));
    CHECK(std::abs(shape.shear - degrees * kDegree) < 1e-12);
  }
}

TEST_CASE("describe_grid: a turned box is oblique without shear; a flipped axis is mirrored") {
  const double c = std::cos(20 * kDegree), s = std::sin(20 * kDegree);
  const GridShape turned = describe_grid(grid({1, 0, 0}, {0, c, s}, {0, -s, c}));
  CHECK(turned.shear < kRounding);
  CHECK(std::abs(turned.oblique - 20 * kDegree) < kRounding);
  CHECK(describe_grid(grid({1, 0, 0}, {0, -1, 0}, {0, 0, 1})).mirrored);
}

TEST_CASE("affine_error: flat, endless and absurd grids are distinguished from usable ones") {
  CHECK_FALSE(affine_error(grid({0.5, 0, 0}, {0, 0.5, 0}, {0, 0.3, 1})));
  CHECK(affine_error(grid({1, 0, 0}, {1, 0, 0}, {0, 0, 1})));
  CHECK(affine_error(grid({0, 0, 0}, {0, 1, 0}, {0, 0, 1})));
  CHECK(affine_error(grid({5000, 0, 0}, {0, 1, 0}, {0, 0, 1})));
  CHECK(affine_error(grid({std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, 1, 0}, {0, 0, 1})));
}

TEST_CASE("lps_from_ras: a point to the right and in front is at negative x and y") {
  const Affine lps = lps_from_ras(Affine{Mat3(1.0), Vec3(10, 20, 30)});
  CHECK(lps * Vec3(1, 2, 3) == Vec3(-11, -22, 33));
}
