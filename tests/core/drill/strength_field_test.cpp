#include "core/drill/strength_field.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPitch = 0.25e-3;

double sum_of(const ExposureField& field) {
  double sum = 0.0;
  for_each_voxel(field.box, [&](const Vec3i& v) { sum += field.at(v); });
  return sum;
}

/// A burr of 3 mm with a factor by distance from the axis, finely voxelised.
ErosionPoints burr(double relative_pitch = 0.27) {
  ErosionPoints points = lattice(Ball{1.5e-3}, relative_pitch * kPitch, 0.0f);
  for (std::size_t n = 0; n < points.size(); ++n)
    points.factors[n] = 0.1f * (0.2f + 0.8f * static_cast<float>(std::hypot(points.positions[n].x, points.positions[n].y) / 1.5e-3));
  return points;
}

std::vector<double> weights_of(const ErosionPoints& points) { return {points.factors.begin(), points.factors.end()}; }

struct Agreement {
  double deep = 0.0;   ///< root mean square of the difference where the tool covers the voxel and all round it, over the mean
  double rim = 0.0;    ///< elsewhere, over the same mean
  double total = 0.0;  ///< of the sums
};

ExposureField count(const Voxmap& voxmap, const ErosionPoints& points, const Affine& pose) {
  ExposureField field;
  REQUIRE(PointScatter(points).add(voxmap.window(), pose, field) == 0);
  return field;
}

ExposureField look_up(const Voxmap& voxmap, const StrengthField& strength, const Affine& pose) {
  ExposureField field;
  strength.look_up(voxmap.window(), pose, field);
  return field;
}

Agreement agreement(const Voxmap& voxmap, const Affine& pose, const ExposureField& exact, const ExposureField& looked_up) {
  double mean = 0.0, deep = 0.0, rim = 0.0;
  int deep_count = 0, rim_count = 0;
  const Vec3 middle = pose * Vec3(0.0, 0.0, 1.5e-3);
  for_each_voxel(voxmap.window().box, [&](const Vec3i& v) {
    const double depth = 6.0 - glm::length(Vec3(v) - middle), apart = exact.at(v) - looked_up.at(v);
    if (depth > 1.5) {
      mean += exact.at(v);
      deep += apart * apart;
      ++deep_count;
    } else if (depth > -1.5) {
      rim += apart * apart;
      ++rim_count;
    }
  });
  mean /= deep_count;
  return {std::sqrt(deep / deep_count) / mean, std::sqrt(rim / rim_count) / mean, std::abs(sum_of(looked_up) / sum_of(exact) - 1.0)};
}

}  // namespace

TEST_CASE("gather: agrees with the exact scatter inside, at the rim and in all, a pose half a voxel off does not") {
  const Voxmap voxmap = Block{.dims = Vec3i(30), .pitch = kPitch}.make();
  const ErosionPoints points = burr();
  const StrengthField strength(points, weights_of(points), kPitch);
  Agreement worst, own;
  double least_sabotaged = 1.0;
  const auto widen = [](Agreement& all, const Agreement& a) {
    all = {std::max(all.deep, a.deep), std::max(all.rim, a.rim), std::max(all.total, a.total)};
  };
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Affine pose = turned_pose(kPitch, Vec3(14.0) + 3.0 * Vec3(uniform11(seed, 5), uniform11(seed, 6), uniform11(seed, 7)), seed);
    const ExposureField exact = count(voxmap, points, pose);
    widen(worst, agreement(voxmap, pose, exact, look_up(voxmap, strength, pose)));
    // The scatter's own unevenness: the same points a quarter of their pitch further, which is nothing to the steel they stand for.
    widen(own, agreement(voxmap, pose, exact, count(voxmap, points, moved(pose, pose.linear * Vec3(0.25 * points.pitch)))));
    const Agreement off = agreement(voxmap, pose, exact, look_up(voxmap, strength, moved(pose, Vec3(0.5, 0.0, 0.0))));
    least_sabotaged = std::min(least_sabotaged, off.rim);
  }
  MESSAGE("difference over the mean: inside " << worst.deep << ", at the rim " << worst.rim << ", of the sum " << worst.total
                                              << "; the scatter's own: inside " << own.deep << ", at the rim " << own.rim
                                              << "; rim of a pose half a voxel off " << least_sabotaged);
  // A voxel 3.7 points wide holds 51 of them give or take what the lattice's planes happen to do; the table has that smoothed away, so it
  // is one such deviation off the scatter, and two scatters are root two of it off each other.
  CHECK(worst.deep < own.deep);
  // At the rim add the node, up to 1/6 voxel off on each axis, 0.1 voxel along the normal as a root mean square, where the exposure
  // falls from full to nothing over little more than a voxel.
  CHECK(worst.rim < own.rim + 0.1);
  CHECK(worst.total < 0.01);  // nodes' offsets average out over some thousand voxels
  CHECK(least_sabotaged > 1.5 * worst.rim);
}

TEST_CASE("gather: bone removed along a path is the scatter's within 2 %, and the same bits come at every SIMD level") {
  const SimdLevelGuard guard;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const ErosionPoints points = burr(0.4);
    const Affine from = turned_pose(kPitch, Vec3(11.0, 12.0, 10.0), seed);
    const ErosionPath path{from, moved(from, Vec3(6.0, 4.0, 3.0))};
    const auto mass = [&](ErosionForm form) {
      Voxmap voxmap = Block{.dims = Vec3i(36), .pitch = kPitch}.make();
      Erosion erosion = make_erosion(points, {.form = form});
      const Drilling drilling = drill(voxmap, erosion, path, 300.0, 0.1, 50);
      CHECK(drilling.outside == 0);
      return std::pair(drilling.mass, voxmap.hash());
    };
    const double exact = mass(ErosionForm::scatter).first;
    std::uint64_t first = 0;
    for (const SimdLevel level : simd_levels()) {
      REQUIRE(choose_simd(name_of(level)).ok());
      const auto [removed, hash] = mass(ErosionForm::gather);
      if (first == 0) first = hash;
      CHECK(hash == first);
      if (level == simd_levels().front()) MESSAGE("seed " << seed << ": " << removed * 1e9 << " of " << exact * 1e9 << " mm3");
      CHECK(std::abs(removed / exact - 1.0) < 0.02);  // the rim's blur of under half a voxel, in and out, on a radius of six
    }
    REQUIRE(choose_simd("auto").ok());
  }
}

TEST_CASE("gather: what leaves the window counts its points and erodes inside only; without points nothing is looked up") {
  Voxmap voxmap = Block{.dims = Vec3i(20), .pitch = kPitch}.make();
  REQUIRE(voxmap.place_window({Vec3i(2), Vec3i(18)}).ok());
  const ErosionPoints points = burr(0.5);
  Erosion gather = make_erosion(points, {.form = ErosionForm::gather}), scatter = make_erosion(points);
  for (const double x : {10.0, 4.0, 17.0, -3.0, 400.0}) {
    const Affine pose = turned_pose(kPitch, Vec3(x, 9.0, 7.0), 3);
    const ErosionOutcome a = gather.step(voxmap, {pose, pose}, 5.0, 1e-3), b = scatter.step(voxmap, {pose, pose}, 5.0, 1e-3);
    CHECK(a.outside == b.outside);
    CHECK(voxmap.window().erodible_box().contains(a.changed.bounds()));
  }
  ExposureField none;
  StrengthField({}, {}, kPitch).look_up(voxmap.window(), Affine{}, none);
  CHECK(none.box.empty());
}
