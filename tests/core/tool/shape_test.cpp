#include "core/tool/shape.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/core/tool/tool_samples.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

struct Sample {
  std::string name;
  Solid solid;
};

std::vector<Sample> samples() {
  return {{"cylinder", make_cylinder(1e-3, 3e-3, 5.5e-3)},
          {"cone", make_cone(0.0, 4e-3, 2e-3)},
          {"frustum", make_frustum({.z_low = 2e-3, .height = 3e-3, .low_radius = 4e-3, .high_radius = 1e-3})},
          {"sphere", make_sphere(0.0, 2e-3)},
          {"prolate", make_ellipsoid(1e-3, 8e-3, 2e-3)},
          {"oblate", make_ellipsoid(0.0, 2e-3, 3e-3)},
          {"tube", make_tube({.z_low = 1e-3, .height = 3e-3, .low_radius = 6e-3, .high_radius = 6e-3}, {4e-3, 4e-3})},
          {"conical tube", make_tube({.z_low = 0.0, .height = 5e-3, .low_radius = 3e-3, .high_radius = 4e-3}, {1e-3, 3e-3})},
          {"knife edge", make_tube({.z_low = 0.0, .height = 5e-3, .low_radius = 2e-3, .high_radius = 4e-3}, {2e-3, 2e-3})}};
}

Solid sample_box() { return make_box({.z_low = 1e-3, .height = 2e-3, .size = {12e-3, 0.6e-3}, .centre = {1.5e-3, -2e-3}}); }

/// Volume by midpoint slices of the profile; independent of the closed forms.
double sliced_volume(const Solid& solid, int slices) {
  double sum = 0.0;
  for (int i = 0; i < slices; ++i) {
    const double z = solid.z_low + solid.height() * (i + 0.5) / slices;
    sum += kPi * (solid.squared_radius(z) - solid.bore(z) * solid.bore(z));
  }
  return sum * solid.height() / slices;
}

/// Area by frusta between points of the profile, spaced evenly in angle so that the poles of an ellipsoid do not dominate the error.
double banded_area(const Solid& solid, int bands) {
  const auto disc = [&](double z) { return kPi * (solid.squared_radius(z) - solid.bore(z) * solid.bore(z)); };
  double sum = disc(solid.z_low) + disc(solid.z_high);
  const auto height = [&](int i) { return solid.z_low + 0.5 * solid.height() * (1.0 - std::cos(kPi * i / bands)); };
  for (int i = 0; i < bands; ++i) {
    const double z0 = height(i), z1 = height(i + 1), r0 = solid.radius(z0), r1 = solid.radius(z1);
    sum += kPi * (r0 + r1) * std::hypot(z1 - z0, r1 - r0);
    const double b0 = solid.bore(z0), b1 = solid.bore(z1);
    if (b0 + b1 > 0.0) sum += kPi * (b0 + b1) * std::hypot(z1 - z0, b1 - b0);
  }
  return sum;
}

}  // namespace

TEST_CASE("solid: closed forms are the integrals of the profile") {
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    // the midpoint rule's error on a quadratic is 1 / (4 n^2) of the volume or less: 2e-9 at 10000 slices
    CHECK(sample.solid.volume() == doctest::Approx(sliced_volume(sample.solid, 10000)).epsilon(1e-8));
    // chords shorten an arc by (pi / n)^2 / 24 and less: 2e-8 at 5000; 1e-6 leaves room for the ends, where cos loses digits
    CHECK(sample.solid.area() == doctest::Approx(banded_area(sample.solid, 5000)).epsilon(1e-6));
  }
}

TEST_CASE("solid: closed forms of the textbook") {
  CHECK(make_cylinder(0.0, 2.0, 3.0).volume() == doctest::Approx(18.0 * kPi).epsilon(1e-14));
  CHECK(make_cylinder(0.0, 2.0, 3.0).area() == doctest::Approx(2.0 * kPi * 9.0 + 12.0 * kPi).epsilon(1e-14));
  CHECK(make_cone(0.0, 4.0, 3.0).volume() == doctest::Approx(12.0 * kPi).epsilon(1e-14));
  CHECK(make_cone(0.0, 4.0, 3.0).area() == doctest::Approx(kPi * 9.0 + kPi * 3.0 * 5.0).epsilon(1e-14));
  CHECK(make_sphere(0.0, 2.0).volume() == doctest::Approx(32.0 / 3.0 * kPi).epsilon(1e-14));
  CHECK(make_sphere(0.0, 2.0).area() == doctest::Approx(16.0 * kPi).epsilon(1e-14));
  CHECK(make_ellipsoid(0.0, 2.0 + 1e-7, 1.0).area() ==
        doctest::Approx(4.0 * kPi).epsilon(1e-6));  // next to a sphere, where e almost vanishes
}

TEST_CASE("solid: the share of random points inside is the closed-form volume") {
  constexpr int kPoints = 200000;
  std::vector<Sample> all = samples();
  all.push_back({"box", sample_box()});
  for (const Sample& sample : all) {
    CAPTURE(sample.name);
    const auto [tight_lo, tight_hi] = sample.solid.bounds();
    // A box fills its bounds: looked at in a space 1.4 times as wide, or every point would be inside.
    const Vec3 middle = 0.5 * (tight_lo + tight_hi), half = (sample.solid.revolves() ? 0.5 : 0.7) * (tight_hi - tight_lo);
    const Vec3 lo = middle - half, hi = middle + half;
    int inside = 0;
    for (int i = 0; i < kPoints; ++i) inside += sample.solid.contains(random_point(5, static_cast<std::uint64_t>(i), lo, hi)) ? 1 : 0;
    const double box = (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z);
    // five standard deviations of a share of at least 0.25 of 200000 draws: 5 * sqrt(0.75 / 0.25 / 2e5) = 2 %
    CHECK(box * inside / kPoints == doctest::Approx(sample.solid.volume()).epsilon(0.02));
  }
}

TEST_CASE("solid: r^2 equals its quadratic form everywhere on the solid and nothing is inside beyond the ends") {
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    const auto form = sample.solid.squared_radius_form();
    for (int i = 0; i <= 100; ++i) {
      const double z = sample.solid.z_low + sample.solid.height() * i / 100;
      // rounding of terms of at most 1e-4 m^2 in size
      CHECK(std::abs(sample.solid.squared_radius(z) - (form.a * z * z + form.b * z + form.c)) < 1e-17);
    }
    CHECK_FALSE(sample.solid.contains({0.0, 0.0, sample.solid.z_low - 1e-9}));
    CHECK_FALSE(sample.solid.contains({0.0, 0.0, sample.solid.z_high + 1e-9}));
    CHECK(sample.solid.contains({0.0, 0.0, 0.5 * (sample.solid.z_low + sample.solid.z_high)}) == !sample.solid.bored());
  }
}

TEST_CASE("solid: a tube is its outer solid less its bore, point by point; its walls belong to it") {
  const FrustumSize outer{.z_low = 0.0, .height = 5e-3, .low_radius = 3e-3, .high_radius = 4e-3};
  const FrustumSize bore{.z_low = 0.0, .height = 5e-3, .low_radius = 1e-3, .high_radius = 3e-3};
  const Solid tube = make_tube(outer, {bore.low_radius, bore.high_radius}), whole = make_frustum(outer), hole = make_frustum(bore);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vec3 p = random_point(31, i, Vec3(-4e-3, -4e-3, -1e-3), Vec3(4e-3, 4e-3, 6e-3));
    CHECK(tube.contains(p) == (whole.contains(p) && !hole.contains(p)));  // no random point lies on a wall
  }
  CHECK(tube.volume() == doctest::Approx(whole.volume() - hole.volume()).epsilon(1e-13));  // rounding
  CHECK(make_tube({.height = 1.0, .low_radius = 2.0, .high_radius = 2.0}, {1.0, 1.0}).contains({1.0, 0.0, 0.5}));
}

TEST_CASE("solid: a box in closed form, its bounds and its greatest radius") {
  const Solid box = make_box({.z_low = 1.0, .height = 4.0, .size = {2.0, 3.0}, .centre = {-5.0, 0.5}});
  CHECK(box.volume() == doctest::Approx(24.0).epsilon(1e-14));
  CHECK(box.area() == doctest::Approx(2.0 * (6.0 + 8.0 + 12.0)).epsilon(1e-14));
  CHECK(box.bounds().lo == Vec3(-6.0, -1.0, 1.0));
  CHECK(box.bounds().hi == Vec3(-4.0, 2.0, 5.0));
  CHECK(box.largest_radius() == doctest::Approx(std::hypot(6.0, 2.0)).epsilon(1e-14));
  CHECK(box.contains({-6.0, 2.0, 5.0}));
  CHECK_FALSE(box.contains({-6.0 - 1e-9, 0.0, 3.0}));
}
