#include "volumes/phantom/pore_field.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "tests/volumes/phantom/phantom_support.h"

namespace burrhole {
namespace {

using namespace phantom_test;

constexpr double kPore = 1.2e-3;

std::vector<Vec3> points_in(double half, std::uint64_t seed, std::uint64_t count) {
  std::vector<Vec3> points;
  for (std::uint64_t n = 0; n < count; ++n) points.push_back(random_point(seed, n, Vec3(-half), Vec3(half)));
  return points;
}

TEST_CASE("pores: the share met on fresh points is the share asked for") {
  const std::vector<Vec3> fresh = points_in(0.03, 99, 20000);
  for (const double porosity : {0.05, 0.3, 0.6}) {
    const PoreField field = PoreField::calibrated(4, kPore, porosity, points_in(0.03, 98, 20000));
    double hit = 0.0;
    for (const Vec3& p : fresh) hit += field.in_pore(p);
    // Two independent samples of 20,000: four standard errors of their difference are 4 sqrt(2 * 0.25 / 20000) = 0.02.
    CHECK(std::abs(hit / 20000.0 - porosity) < 0.02);
  }
}

TEST_CASE("pores: none at porosity 0, nothing else at 1") {
  const std::vector<Vec3> points = points_in(0.01, 3, 500);
  const PoreField none = PoreField::calibrated(1, kPore, 0.0, points), all = PoreField::calibrated(1, kPore, 1.0, points);
  for (const Vec3& p : points) {
    CHECK(none.share(p, 0.25e-3) == 0.0);
    CHECK(all.share(p, 0.25e-3) == 1.0);
  }
}

TEST_CASE("pores: the field is smooth: no jump in value or slope along a line across many lattice cells") {
  const PoreField field = PoreField::calibrated(4, kPore, 0.4, points_in(0.01, 5, 2000));
  const Vec3 unit = glm::normalize(Vec3(0.3, -0.5, 0.8));
  const double step = 1e-7;
  double before = field.value(Vec3(0.0)), slope_before = 0.0;
  for (int n = 1; n < 100000; ++n) {
    const double now = field.value(n * step * unit), slope = (now - before) / step;
    // Slopes of the fade are at most 15/8 an axis and lattice edge (3.25 along any line), second derivatives at most 5.8 an axis and
    // edge^2; cross terms included 30 holds. 1e-9/step is the rounding of the difference quotient.
    REQUIRE(std::abs(slope) < 3.3 / kPore);
    if (n > 1) REQUIRE(std::abs(slope - slope_before) < 30.0 / (kPore * kPore) * step + 1e-15 / step);
    before = now, slope_before = slope;
  }
}

TEST_CASE("pores: at the default porosity a random line crosses them in chords of the pore size") {
  const PoreField field = PoreField::calibrated(4, kPore, 0.4, points_in(0.03, 98, 20000));
  double inside = 0.0;
  int entries = 0;
  const double step = 0.02e-3;
  for (std::uint64_t n = 0; n < 400; ++n) {
    const Vec3 from = random_point(6, n, Vec3(-0.03), Vec3(0.03)), unit = random_direction(7, n);
    bool was = field.in_pore(from);
    for (int s = 1; s <= 1500; ++s) {
      const bool now = field.in_pore(from + s * step * unit);
      inside += now ? step : 0.0;
      entries += now && !was;
      was = now;
    }
  }
  // 400 lines of 30 mm cross some 4,000 pores whose chords scatter by about their mean: 2 % standard error; 10 % is what "mean width"
  // claims.
  MESSAGE("mean chord / pore size = " << inside / entries / kPore);
  CHECK(agree(inside / entries, kPore, 0.1));
}

TEST_CASE("pores: the wall's ramp is about as wide as asked for") {
  const PoreField field = PoreField::calibrated(4, kPore, 0.4, points_in(0.03, 98, 20000));
  const double width = 0.1e-3;  // well under a pore, so that the field is nearly straight across the wall
  double partial = 0.0, walls = 0.0;
  const double step = 0.01e-3;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Vec3 from = random_point(8, n, Vec3(-0.03), Vec3(0.03)), unit = random_direction(9, n);
    for (int s = 0; s < 2000; ++s) {
      const Vec3 p = from + s * step * unit;
      const double share = field.share(p, width);
      partial += share > 0.0 && share < 1.0 ? step : 0.0;
      walls += field.in_pore(p) != field.in_pore(p + step * unit);
    }
  }
  // A line meets walls at all angles (mean of 1/cosine weighted by cosine: twice the width) and slopes vary by half about their mean.
  MESSAGE("mean ramp along a line / width = " << partial / walls / width);
  CHECK(partial / walls > 1.0 * width);
  CHECK(partial / walls < 4.0 * width);
}

TEST_CASE("pores: sabotage twin, a field keyed to the voxel instead of the place changes with the pitch") {
  const auto keyed_to_voxel = [](const Vec3& p, double pitch) {
    const Vec3 v = glm::floor(p / pitch);
    return uniform01(4, static_cast<std::uint64_t>(static_cast<std::int64_t>(v.x + 100 * v.y + 10000 * v.z))) < 0.4;
  };
  int differ = 0;
  for (const Vec3& p : points_in(0.005, 10, 1000)) differ += keyed_to_voxel(p, 0.6e-3) != keyed_to_voxel(p, 0.2e-3);
  CHECK(differ > 300);  // about 2 * 0.4 * 0.6 of the points
}

}  // namespace
}  // namespace burrhole
