// Blood that flows, pools, overflows, is rinsed and sucked away: closed forms, any step, the balance. A compartment that is left out of the
// balance must be noticed.
#include "core/blood/blood_pool.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace burrhole;

namespace {

constexpr double kFar = 1e9;  // [s]

/// A square shaft: 4 x 4 mm wide, 6 mm deep, in 1 mm voxels, so that each figure is exact; its pores open with `pores` of the area.
struct Shaft {
  explicit Shaft(double pores = 0.5) : site(bone(pores)) {
    std::vector<float> left;
    const VoxelBox of = site.box().grown(1);
    for_each_voxel(of, [&](const Vec3i& v) { left.push_back(v.z >= 0 || hole().contains(v) ? 0.0f : 1.0f); });
    site.update(site.box(), left, 0.0, kFar);
  }
  static VoxelBox hole() { return {Vec3i(-2, -2, -6), Vec3i(2, 2, 0)}; }
  static SiteBone bone(double pores) {
    SiteBone out{.box = {Vec3i(-4, -4, -8), Vec3i(4, 4, 2)}, .bone_from_index = Affine::scaling(1e-3, Vec3(0.0, 0.0, 0.5e-3))};
    for_each_voxel(out.box, [&](const Vec3i& v) {
      out.whole.push_back(v.z < 0 ? 1.0f : 0.0f);
      out.pores.push_back(v.z < 0 ? static_cast<float>(pores) : 0.0f);
      out.outside.push_back(v.z < 0 ? 0 : 1);
    });
    out.start = out.whole;
    return out;
  }
  BloodSite site;
};
constexpr double kArea = 16e-6, kVolume = 96e-9;  // [m^2], [m^3] of the shaft

/// No hydrostatic pressure, no coagulation, no film, so that the flow is constant.
BloodConfig plain() {
  return {.pressure = 1000.0, .conductance = 1e-7, .coagulation = kFar, .film_time = 1e-9, .wash_time = 1.0, .weight = 0.0, .suction = 0.0};
}

bool balanced(const BloodVolumes& v) { return std::abs(v.missing()) <= 1e-13 * std::max(v.bled, 1e-12); }

}  // namespace

TEST_CASE("blood: a plane of known pore area bleeds conductance x area x pressure, and fills the hole to V / A, at any step") {
  for (const double dt : {1e-3, 0.01, 0.1}) {
    Shaft shaft;
    BloodPool pool(plain());
    const double flow = 1e-7 * 1000.0 * shaft.site.open_pores();
    const int steps = static_cast<int>(0.4 * kVolume / flow / dt);
    for (int n = 0; n < steps; ++n) {
      pool.step(shaft.site, 0.0, dt);
      CHECK(balanced(pool.volumes()));
    }
    CHECK(pool.flow() == doctest::Approx(flow).epsilon(1e-6));  // coagulation of 1e9 s
    CHECK(pool.volumes().bled == doctest::Approx(flow * dt * steps).epsilon(1e-6));
    CHECK(pool.volumes().overflowed == 0.0);
    CHECK(pool.level() - shaft.site.floor() == doctest::Approx(flow * dt * steps / kArea).epsilon(1e-4));
    CHECK(pool.blood_depth(shaft.site) == doctest::Approx(pool.volumes().hole / kArea).epsilon(1e-4));
  }
}

TEST_CASE("blood: coagulation integrates to q tau (1 - exp(-t / tau)) at steps of 1 to 100 ms, and full holes overflow") {
  const double tau = 7.0, end = 20.0;
  for (const double dt : {1e-3, 0.01, 0.1}) {
    Shaft shaft;
    BloodConfig config = plain();
    config.coagulation = tau;
    config.conductance = 1e-5;
    BloodPool pool(config);
    const double flow = 1e-5 * 1000.0 * shaft.site.open_pores();
    for (int n = 0; n < static_cast<int>(end / dt + 0.5); ++n) pool.step(shaft.site, 0.0, dt);
    const double bled = flow * tau * (1.0 - std::exp(-end / tau));
    CHECK(pool.volumes().bled == doctest::Approx(bled).epsilon(1e-9));
    REQUIRE(bled > kVolume);
    CHECK(pool.volumes().hole == doctest::Approx(kVolume).epsilon(1e-6));
    CHECK(pool.volumes().overflowed == doctest::Approx(bled - kVolume).epsilon(1e-6));
    CHECK(pool.level() == doctest::Approx(shaft.site.spill()).scale(1e-3));
    CHECK(balanced(pool.volumes()));
  }
}

TEST_CASE("blood: saline rinses a full hole as exp(-s t / V), at any step; with bleeding it comes to the steady share") {
  const double s = 30e-6 / 60.0;
  for (const double dt : {1e-3, 0.01, 0.1}) {
    Shaft shaft;
    BloodConfig config = plain();
    config.conductance = 1e-4;
    BloodPool pool(config);
    for (int n = 0; n < 200 && pool.volumes().hole < kVolume; ++n) pool.step(shaft.site, 0.0, 0.1);
    const double bled = pool.volumes().bled, overflowed = pool.volumes().overflowed;
    (void)shaft.site.wax(0.0);
    for (int n = 0; n < 40 * static_cast<int>(0.1 / dt + 0.5) / 10; ++n) pool.step(shaft.site, s, dt);
    const double t = 0.4;
    CHECK(pool.volumes().hole == doctest::Approx(kVolume * std::exp(-s * t / kVolume)).epsilon(1e-6));
    CHECK(pool.volumes().rinsed == doctest::Approx(kVolume * (1.0 - std::exp(-s * t / kVolume))).epsilon(1e-6));
    CHECK(pool.volumes().bled == bled);
    CHECK(pool.volumes().overflowed == overflowed);
    CHECK(balanced(pool.volumes()));

    Shaft fresh;
    config.conductance = 1e-6;
    BloodPool steady(config);
    const double flow = 1e-6 * 1000.0 * fresh.site.open_pores();
    for (int n = 0; n < static_cast<int>(60.0 / dt); ++n) steady.step(fresh.site, s, dt);
    CHECK(steady.volumes().hole == doctest::Approx(kVolume * flow / (flow + s)).epsilon(1e-5));
  }
}

TEST_CASE("blood: in a deep hole it rises to the head of its pressure and no higher, at any conductance and step") {
  for (const double conductance : {1e-7, 1e-5, 1e-3, 1.0})
    for (const double dt : {1e-3, 0.02, 0.1}) {
      CAPTURE(conductance);
      CAPTURE(dt);
      Shaft shaft;
      BloodConfig config = plain();
      config.conductance = conductance;
      config.weight = 1e4;
      config.pressure = 20.0;  // 2 mm over the source at -5.5 mm and the floor's at -6.5 mm
      config.film_time = 0.05;
      BloodPool pool(config);
      double before = -1.0;
      for (int n = 0; n < static_cast<int>(3.0 / dt); ++n) {
        pool.step(shaft.site, 0.0, dt);
        CHECK(pool.level() >= before - 1e-12);
        before = pool.level();
        CHECK(std::isfinite(pool.flow()));
        CHECK(pool.flow() >= 0.0);
      }
      // Sources up to the rim are 2 mm above their own surface at most: the upper ones go on until the level is theirs + 2 mm, beyond the rim.
      CHECK(pool.level() <= shaft.site.spill() + 1e-12);
      CHECK(balanced(pool.volumes()));
    }
}

TEST_CASE("blood: film keeps what has not run down: a linear reservoir, at any step; saline washes it faster") {
  for (const double dt : {1e-3, 0.01, 0.1}) {
    Shaft shaft;
    BloodConfig config = plain();
    config.film_time = 2.0;
    config.wash_time = 0.5;
    BloodPool pool(config);
    const double flow = 1e-7 * 1000.0 * shaft.site.open_pores();
    for (int n = 0; n < static_cast<int>(1.0 / dt + 0.5); ++n) pool.step(shaft.site, 0.0, dt);
    CHECK(pool.volumes().film == doctest::Approx(flow * 2.0 * (1.0 - std::exp(-0.5))).epsilon(1e-6));
    for (int n = 0; n < static_cast<int>(60.0 / dt + 0.5); ++n) pool.step(shaft.site, 1e-9, dt);
    CHECK(pool.volumes().film == doctest::Approx(flow / (1.0 / 2.0 + 1.0 / 0.5)).epsilon(1e-6));
    CHECK(balanced(pool.volumes()));
  }
}

TEST_CASE("blood: the balance holds in each step of a random course; leaving out what was rinsed or sucked is noticed") {
  std::mt19937 random(11);  // seed 11
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  BloodConfig config = plain();
  config.conductance = 3e-5;
  config.film_time = 0.3;
  config.weight = 1e4;
  config.coagulation = 5.0;
  config.suction = 5e-8;
  BloodPool pool(config);
  Shaft shaft;
  const VoxelBox box = shaft.site.box();
  for (int n = 0; n < 3000; ++n) {
    const bool shrinks = n % 500 == 400;  // bone comes back, and goes again
    if (shrinks || n % 500 == 450) {
      std::vector<float> left;
      for_each_voxel(box.grown(1),
                     [&](const Vec3i& v) { left.push_back(v.z >= 0 || (!shrinks && Shaft::hole().contains(v)) ? 0.0f : 1.0f); });
      shaft.site.update(box, left, 0.02 * n, config.coagulation);
    }
    if (n % 700 == 600) (void)shaft.site.wax(0.0);
    pool.step(shaft.site, uniform(random) < 0.5 ? 0.0 : 1e-6 * uniform(random), std::pow(10.0, -3.0 + 2.0 * uniform(random)));
    const BloodVolumes& v = pool.volumes();
    REQUIRE(balanced(v));
    for (const double one : {v.bled, v.hole, v.film, v.rinsed, v.sucked, v.overflowed, v.saline}) REQUIRE(one >= -1e-18);
    REQUIRE(v.in_hole() <= shaft.site.capacity() * (1.0 + 1e-9) + 1e-18);
  }
  BloodVolumes wrong = pool.volumes();
  CHECK(wrong.rinsed > 0.0);
  CHECK(wrong.sucked > 0.0);
  CHECK(wrong.overflowed > 0.0);
  wrong.rinsed = 0.0;
  CHECK_FALSE(balanced(wrong));
  wrong = pool.volumes();
  wrong.sucked = 0.0;
  CHECK_FALSE(balanced(wrong));
}

TEST_CASE("blood: a sucker that takes more than flows in leaves the hole empty") {
  Shaft shaft;
  BloodConfig config = plain();
  config.suction = 1e-6;
  BloodPool pool(config);
  for (int n = 0; n < 100; ++n) pool.step(shaft.site, 0.0, 0.02);
  CHECK(pool.volumes().hole == 0.0);
  CHECK(pool.volumes().sucked == doctest::Approx(pool.volumes().bled).epsilon(1e-6));
  CHECK(pool.level() == shaft.site.floor());
}
