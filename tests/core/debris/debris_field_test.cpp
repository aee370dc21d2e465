// Chips as a whole: the balance at each step, the heap, what falls again, rinsing and suction, the budget, undo, the same bits.

#include "core/debris/debris_field.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "tests/core/debris/small_site.h"

namespace burrhole::test {
namespace {

constexpr double kMm3 = 1e-9;  // [m^3]

/// Bone below z = 0.
DebrisField flat_field(const DebrisConfig& config = {}, const Vec3& down = Vec3(0.0, 0.0, -1.0), double cell = 0.5e-3, double half = 4e-3) {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)), down, cell, half);
  fill(site, [](const Vec3& p) { return std::clamp(0.5 - p.z / 0.25e-3, 0.0, 1.0); });
  auto field = DebrisField::create(config, std::move(site));
  REQUIRE(field);
  return std::move(*field);
}

DebrisBit bit(double spin, double z = 0.0) {
  return {.tip = Vec3(0.0, 0.0, z), .axis = Vec3(0.0, 0.0, 1.0), .radius = 1e-3, .height = 2e-3, .spin = spin};
}

DebrisStep cutting(double dt, double removed, double spin = 17.0) {
  return {.dt = dt, .removed = removed, .thickness = 5e-6, .bit = bit(spin)};
}

/// Drills for a second and drops what the bit holds; the bit is then far away.
DebrisField drilled(DebrisConfig config = {}, double volume = 10.0 * kMm3, double cell = 0.5e-3, double half = 4e-3) {
  config.particle = 0.05 * kMm3;  // loose, one fills a heap cell
  DebrisField field = flat_field(config, Vec3(0.0, 0.0, -1.0), cell, half);
  for (int n = 0; n < 50; ++n) field.step(cutting(0.02, volume / 50.0));
  for (int n = 0; n < 100; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3)});
  return field;
}

/// Particles that leave at once a bit at 17 turns/s, just thrown: nothing has slowed them.
DebrisField thrown(DebrisConfig config) {
  config.particle = 0.001 * kMm3;
  config.clearing = 1e12;
  config.mist_share = 0.0;
  DebrisField field = flat_field(config);
  for (int n = 0; n < 30; ++n) field.step(cutting(1e-9, 60.0 * config.particle));
  REQUIRE(field.particles().size() > 1700);
  return field;
}

/// Mean, and what it may be off: four of its standard deviations, from the spread of the values.
struct Mean {
  double value, off;
};
Mean mean_of(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  return {sum / count, 4.0 * std::sqrt((squares / count - std::pow(sum / count, 2)) / count)};
}

double sum_of(const DebrisField& field) {
  double sum = 0.0;
  for (const DebrisParticle& one : field.particles()) sum += one.volume;
  return sum;
}

}  // namespace

TEST_CASE("debris: diameters spread evenly in their logarithm, by size_spread, round chip_ratio x thickness within smallest and largest") {
  struct Case {
    double ratio, smallest, largest, spread, middle;  // [-], [m], [m], [-], [m]
  };
  // The chips are 5 um thick.
  for (const Case& one : {Case{20.0, 50e-6, 500e-6, 2.0, 100e-6},
                          {40.0, 50e-6, 500e-6, 2.0, 200e-6},
                          {4.0, 50e-6, 500e-6, 2.0, 50e-6},
                          {4.0, 80e-6, 500e-6, 2.0, 80e-6},
                          {1000.0, 50e-6, 500e-6, 2.0, 500e-6},
                          {1000.0, 50e-6, 300e-6, 2.0, 300e-6},
                          {20.0, 50e-6, 500e-6, 1.0, 100e-6},
                          {20.0, 50e-6, 500e-6, 6.0, 100e-6}}) {
    CAPTURE(one.middle);
    CAPTURE(one.spread);
    const DebrisField field =
        thrown({.chip_ratio = one.ratio, .smallest = one.smallest, .largest = one.largest, .size_spread = one.spread});
    std::vector<double> all;
    for (const DebrisParticle& particle : field.particles()) all.push_back(particle.diameter / one.middle);
    // The mean of s^x over x in -1..1.
    const double log = std::log(one.spread), mean = one.spread > 1.0 ? std::sinh(log) / log : 1.0;
    CHECK(std::abs(mean_of(all).value - mean) < mean_of(all).off + 1e-12);
    CHECK(field.mean_diameter() == doctest::Approx(mean_of(all).value * one.middle).epsilon(1e-12));
    // Of 1700, one in 100 at either end is missed with a chance of 4e-8.
    CHECK(*std::ranges::min_element(all) >= (1.0 - 1e-12) / one.spread);
    CHECK(*std::ranges::min_element(all) <= (1.0 + 1e-12) / std::pow(one.spread, 0.98));
    CHECK(*std::ranges::max_element(all) <= (1.0 + 1e-12) * one.spread);
    CHECK(*std::ranges::max_element(all) >= (1.0 - 1e-12) * std::pow(one.spread, 0.98));
    CHECK(std::abs(mean_of(all).value - 1.1 * mean) > mean_of(all).off);  // sabotage: a tenth more
  }
}

TEST_CASE("debris: chips leave at throw_share of the rim's speed, and up and outwards by 0 to `spread` of their speed along it") {
  constexpr double kRim = 2.0 * std::numbers::pi * 17.0 * 1e-3;  // [m/s]
  for (const auto& [share, spread] : {std::pair{0.5, 0.5}, {1.0, 0.5}, {0.5, 0.0}, {0.5, 1.0}, {4.0, 2.0}}) {
    CAPTURE(share);
    CAPTURE(spread);
    std::vector<double> speeds, outwards, up;
    const DebrisField field = thrown({.throw_share = share, .spread = spread});
    for (const DebrisParticle& one : field.particles()) {
      const Vec3 out = glm::normalize(Vec3(one.position.x, one.position.y, 0.0));
      const double along = glm::dot(one.velocity, glm::cross(Vec3(0.0, 0.0, 1.0), out));
      speeds.push_back(glm::length(one.velocity) / kRim);
      outwards.push_back(glm::dot(one.velocity, out) / along);
      up.push_back(one.velocity.z / along);
    }
    // In the 30 ns since, drag of up to 300/s has taken 1e-5 of the speed, of at least 0.027 m/s, and gravity as much.
    constexpr double kNear = 3e-5;
    CHECK(std::abs(mean_of(speeds).value - share) < mean_of(speeds).off + kNear);
    CHECK(std::abs(mean_of(speeds).value - 1.1 * share) > mean_of(speeds).off);  // sabotage
    for (const std::vector<double>& ratio : {outwards, up}) {
      CHECK(std::abs(mean_of(ratio).value - 0.5 * spread) < mean_of(ratio).off + kNear);
      CHECK(*std::ranges::min_element(ratio) > -kNear);
      CHECK(*std::ranges::max_element(ratio) < spread + kNear);
      CHECK(*std::ranges::max_element(ratio) > 0.98 * spread - kNear);
    }
  }
}

TEST_CASE("debris: what goes beyond the site is lost: of a narrower one, what a wider one finds out there") {
  // Coarse chips that leave the bit at once, too few for a heap. A chip that rests within 2 mm of the axis, along x and y, was never beyond, and one
  // that was rests there.
  constexpr double kVolume = 1.0 * kMm3, kCount = 400.0;
  const auto scattered = [&](double half) {
    DebrisField field =
        flat_field({.particle = kVolume / kCount, .chip_ratio = 1000.0, .clearing = 100.0, .throw_share = 2.0, .mist_share = 0.0},
                   Vec3(0.0, 0.0, -1.0), 0.5e-3, half);
    for (int n = 0; n < 50; ++n) field.step(cutting(0.02, kVolume / 50.0));
    return field;
  };
  const DebrisField wide = scattered(4e-3), narrow = scattered(2e-3);
  double beyond = wide.totals().lost;
  for (const DebrisParticle& one : wide.particles())
    beyond += std::max(std::abs(one.position.x), std::abs(one.position.y)) > 2e-3 ? one.volume : 0.0;
  const double share = beyond / kVolume;
  REQUIRE(share > 0.2);
  REQUIRE(share < 0.9);
  // Draws differ once a chip is lost: a binomial scatter of either.
  CHECK(std::abs(narrow.totals().lost / kVolume - share) < 4.0 * std::sqrt(2.0 * share * (1.0 - share) / kCount));
  CHECK(wide.totals().lost / kVolume < share - 0.1);  // the sabotage: what goes beyond the wider one
}

TEST_CASE("debris: the balance closes to rounding at every step of 1 to 100 ms, with saline, suction, stops and a small budget") {
  for (const double dt : {1e-3, 0.02, 0.1})
    for (const double spin : {0.5, 17.0, 3000.0})
      for (const std::size_t most : {1u, 40u, 8000u}) {
        DebrisField field = flat_field({.most_particles = most});
        double worst = 0.0;
        for (int n = 0; n < static_cast<int>(1.0 / dt); ++n) {
          const bool turns = uniform01(7, static_cast<std::uint64_t>(n) / 5) < 0.7;
          DebrisStep now = cutting(dt, turns ? 20.0 * kMm3 * dt * uniform01(8, static_cast<std::uint64_t>(n)) : 0.0, turns ? spin : 0.0);
          if (n % 7 == 3) now.rinse = {Vec3(0.0), 2e-3, 0.5e-6};
          if (n % 11 == 5) now.suction = {Vec3(1e-3, 0.0, 2e-3), 2e-3, 3e-4};
          field.step(now);
          worst = std::max(worst, field.balance_error());
          REQUIRE(field.particles().size() <= most);
          for (const DebrisParticle& one : field.particles()) {
            REQUIRE(one.volume > 0.0);
            REQUIRE(field.site().contains(one.position));
          }
        }
        CAPTURE(dt);
        CAPTURE(spin);
        CAPTURE(most);
        // Sums of up to 8000 terms, some thousand times: 1e-16 each, in the worst case all of one sign.
        CHECK(worst < 1e-11);
        // Sabotage: a volume that is nowhere would show.
        CHECK(std::abs(field.totals().removed - 1.001 * (field.held() + sum_of(field))) > 1e-11 * field.totals().removed);
      }
}

TEST_CASE("debris: chips settle on bone, none inside it and none in the air, and lie in a heap that is lower at its rim") {
  // 25 mm^3 of loose chips: a cone of 45 degrees would be 2.9 mm wide, in a site of 4 mm.
  DebrisField field = drilled({.throw_share = 0.2, .mist_share = 0.0});
  CHECK(field.flying() == 0.0);
  CHECK(field.settled() + field.totals().lost == doctest::Approx(10.0 * kMm3).epsilon(1e-12));
  REQUIRE(field.settled() > 9.0 * kMm3);
  double near = 0.0, far = 0.0;
  for (const DebrisParticle& one : field.particles()) {
    CHECK(one.settled);
    CHECK_FALSE(field.site().is_solid(one.position));
    CHECK(field.site().is_carried(one.position));
    const double r = std::hypot(one.position.x, one.position.y);
    near = std::max(near, r < 2e-3 ? one.position.z : 0.0);
    far = std::max(far, r > 3.5e-3 ? one.position.z : 0.0);
  }
  CHECK(near > far);
}

TEST_CASE(
    "debris: a heap cell is full with the cube of its edge of loose chips, `bulk` times their bone; a twin counts the particles anew") {
  for (const double cell : {0.5e-3, 0.7e-3})
    for (const double bulk : {2.0, 4.0}) {
      CAPTURE(cell);
      CAPTURE(bulk);
      const DebrisField field = drilled({.throw_share = 0.2, .mist_share = 0.0, .bulk = bulk}, 10.0 * kMm3, cell);
      const DebrisSite& site = field.site();
      CHECK(std::abs(site.cell_volume() / (cell * cell * cell) - 1.0) < 1e-12);
      CHECK(site.cells() == static_cast<std::size_t>(std::pow(std::floor(8e-3 / cell) + 1.0, 3.0)));
      std::vector<double> fills(site.cells(), 0.0);
      for (const DebrisParticle& one : field.particles()) fills[site.cell_of(one.position)] += bulk * one.volume;
      int full = 0, sabotaged = 0;
      for (std::size_t n = 0; n < fills.size(); ++n) {
        if (std::abs(fills[n] / (cell * cell * cell) - 1.0) < 1e-5) continue;  // floats
        CHECK(site.is_full(n) == (fills[n] > cell * cell * cell));
        full += site.is_full(n) ? 1 : 0;
        sabotaged += site.is_full(n) != (0.5 * fills[n] > cell * cell * cell) ? 1 : 0;
      }
      CHECK(full > 0);
      CHECK(sabotaged > 0);  // half the bulk
    }
}

TEST_CASE("debris: with a tilt of gravity chips drift to the lower side") {
  const auto centre = [](const Vec3& down) {
    DebrisField field = flat_field({}, down);
    for (int n = 0; n < 50; ++n) field.step(cutting(0.02, 0.2 * kMm3));
    Vec3 sum(0.0);
    for (const DebrisParticle& one : field.particles()) sum += one.volume * one.position;
    return sum / sum_of(field);
  };
  CHECK(std::abs(centre(Vec3(0.0, 0.0, -1.0)).x) < 0.3e-3);
  CHECK(centre(Vec3(0.8, 0.0, -0.6)).x > 0.5e-3);
}

TEST_CASE("debris: when the bone under it goes a chip falls again, to the new floor; a twin by rays from above agrees") {
  DebrisField field = drilled({.mist_share = 0.0}, 2.0 * kMm3);
  // A pit of 1.5 mm for x > 0, 1 mm deep.
  const auto pit = [](const Vec3& p) {
    const double floor = p.x > 0.0 ? -1e-3 : 0.0;
    return std::clamp(0.5 - (p.z - floor) / 0.25e-3, 0.0, 1.0);
  };
  fill(field.site(), pit);
  const double before = field.settled();
  for (int n = 0; n < 50; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3)});
  CHECK(field.settled() + field.flying() == doctest::Approx(before).epsilon(1e-12));
  CHECK(field.flying() == 0.0);
  int fallen = 0;
  for (const DebrisParticle& one : field.particles()) {
    // The twin: the first solid place below, in steps of a hundredth of a voxel.
    double way = 0.0;
    while (!field.site().is_solid(one.position - Vec3(0.0, 0.0, way)) && way < 3e-3) way += 2.5e-6;
    CHECK(way < 0.25e-3 + 0.5e-3 * 3.0);  // a voxel, and the heap's cells below it
    fallen += one.position.z < -0.4e-3 ? 1 : 0;
  }
  CHECK(fallen > 5);
}

TEST_CASE("debris: a heap that the bit held slides into the hole when the bit is gone, to a slope of a cell a cell") {
  DebrisField field = flat_field({.particle = 0.05 * kMm3, .throw_share = 0.1, .mist_share = 0.0});
  for (int n = 0; n < 100; ++n) field.step(cutting(0.02, 0.15 * kMm3));
  const auto inside = [&] {
    double sum = 0.0;
    for (const DebrisParticle& one : field.particles()) sum += std::hypot(one.position.x, one.position.y) < 0.7e-3 ? one.volume : 0.0;
    return sum;
  };
  CHECK(inside() < 0.1 * kMm3);
  for (int n = 0; n < 500; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3)});
  CHECK(inside() > 0.5 * kMm3);
  // The plain twin: no settled chip has an open cell a cell below and beside it that a straight way reaches.
  int steep = 0;
  for (const DebrisParticle& one : field.particles()) steep += one.settled && field.site().slide_from(one.position, 0) ? 1 : 0;
  CHECK(steep < static_cast<int>(field.particles().size()) / 50 + 1);
}

TEST_CASE("debris: rinsing has the closed form: all wet chips in e^(-t / tau), or the load of the saline; each key changes it") {
  DebrisField field = drilled({.mist_share = 0.0});
  const double before = field.settled();
  const auto rinse = [](DebrisField one, double flow, double reach, double dt, int steps) {
    for (int n = 0; n < steps; ++n) one.step({.dt = dt, .bit = bit(0.0, 3e-3), .rinse = {Vec3(0.0), reach, flow}});
    return one.totals().rinsed;
  };
  // Much saline on all: 1 s of tau = 1 s. Particles are whole until a thousandth is left of them.
  const double all = before * (1.0 - std::exp(-1.0));
  CHECK(rinse(field, 1.0, 0.1, 0.02, 50) == doctest::Approx(all).epsilon(1e-12));
  CHECK(rinse(field, 1.0, 0.1, 0.001, 1000) == doctest::Approx(all).epsilon(1e-12));
  CHECK(rinse(field, 1.0, 0.1, 0.1, 10) == doctest::Approx(all).epsilon(1e-12));
  // Little: 1 mm^3/s of saline carries 0.05.
  CHECK(rinse(field, 1.0 * kMm3, 0.1, 0.02, 50) == doctest::Approx(0.05 * kMm3).epsilon(1e-12));
  CHECK(rinse(field, 1.0, 1e-4, 0.02, 50) < 0.1 * all);
  DebrisField slow = drilled({.mist_share = 0.0, .rinse_time = 2.0});
  CHECK(rinse(slow, 1.0, 0.1, 0.02, 50) == doctest::Approx(before * (1.0 - std::exp(-0.5))).epsilon(1e-12));
  DebrisField loaded = drilled({.mist_share = 0.0, .rinse_load = 0.1});
  CHECK(rinse(loaded, 1.0 * kMm3, 0.1, 0.02, 50) == doctest::Approx(0.1 * kMm3).epsilon(1e-12));
}

TEST_CASE("debris: suction takes what falls more slowly than its inflow, within reach, and nothing else") {
  DebrisField field = drilled();
  const Vec3 nozzle(0.5e-3, 0.0, 0.5e-3);
  const double flow = 2e-5, reach = 3e-3;
  double expected = 0.0;
  for (const DebrisParticle& one : field.particles()) {
    const double r = glm::length(one.position - nozzle), speed = flow / (4.0 * std::numbers::pi * r * r);
    const double falls = terminal_speed(chip_drag({}, one.diameter), 9.81);
    if (r <= reach && speed >= falls) expected += one.volume;
  }
  REQUIRE(expected > 0.0);
  REQUIRE(expected < 0.9 * field.settled());
  field.step({.dt = 1e-3, .bit = bit(0.0, 3e-3), .suction = {nozzle, reach, flow}});
  CHECK(field.totals().sucked == doctest::Approx(expected).epsilon(1e-12));
}

TEST_CASE("debris: the hidden share is that of a disc's area under the chips, falls as they are rinsed, and a disc elsewhere is clear") {
  DebrisField field = drilled({}, 20.0 * kMm3);
  const Vec3 up(0.0, 0.0, 1.0);
  const double hidden = field.hidden_share(Vec3(0.0), up, 2e-3);
  CHECK(hidden > 0.5);
  CHECK(field.hidden_share(Vec3(1.0, 0.0, 0.0), up, 2e-3) == 0.0);
  for (int n = 0; n < 400; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3), .rinse = {Vec3(0.0), 0.1, 1.0}});
  CHECK(field.hidden_share(Vec3(0.0), up, 2e-3) < hidden);
  CHECK(field.particles().empty());
  CHECK(field.hidden_share(Vec3(0.0), up, 2e-3) == 0.0);
}

TEST_CASE("debris: the hidden share of one particle is that of its ball, whose volume is `bulk` times its bone") {
  const Vec3 up(0.0, 0.0, 1.0);
  for (const double bulk : {2.0, 6.0}) {
    CAPTURE(bulk);
    DebrisField one = flat_field({.particle = 1.0 * kMm3, .mist_share = 0.0, .bulk = bulk});
    one.step({.dt = 0.02, .removed = 1.0 * kMm3, .bit = bit(0.0)});
    for (int n = 0; n < 50; ++n) one.step({.dt = 0.02, .bit = bit(0.0)});
    REQUIRE(one.particles().size() == 1);
    const double r = one.radius_of(one.particles()[0]), pitch = 2.0 * 2e-3 / DebrisField::kRaster;
    CHECK(r == doctest::Approx(std::cbrt(0.75 * bulk * 1e-9 / std::numbers::pi)));
    // pi r^2 over pi R^2. Nodes of a raster of 64: within two pitches of its rim.
    const Vec3 at(one.particles()[0].position);
    const double bound = 2.0 * pitch * r * 2.0 / 4e-6;
    CHECK(std::abs(one.hidden_share(at, up, 2e-3) - r * r / 4e-6) < bound);
    // Sabotage: over a disc that is wider or lies aside, it is another share.
    CHECK(std::abs(one.hidden_share(at, up, 3e-3) - r * r / 4e-6) > bound);
    CHECK(std::abs(one.hidden_share(at + Vec3(2e-3, 0.0, 0.0), up, 2e-3) - r * r / 4e-6) > bound);
  }
}

TEST_CASE("debris: a full budget merges, keeps the volume, and is counted; a large one does not") {
  const DebrisField large = drilled({.most_particles = 100000}, 30.0 * kMm3), small = drilled({.most_particles = 100}, 30.0 * kMm3);
  CHECK(large.merged() == 0);
  CHECK(small.merged() > 0);
  CHECK(small.most() == 100);
  CHECK(small.balance_error() < 1e-12);
  CHECK(large.most() > 300);
}

TEST_CASE("debris: what the bit holds leaves in turns, a turning bit takes up chips in its reach, and one that stops drops them") {
  DebrisField field = flat_field({.clearing = 0.1});
  field.step(cutting(0.02, 1.0 * kMm3, 10.0));
  // Evenly over 0.2 turns with 0.1 a turn: (1 - e^-0.02) / 0.02.
  CHECK(field.held() == doctest::Approx(kMm3 * (1.0 - std::exp(-0.02)) / 0.02).epsilon(0.06));  // up to a particle waits for its volume
  field.step({.dt = 0.02, .bit = bit(0.0)});
  CHECK(field.held() == 0.0);
  for (int n = 0; n < 50; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3)});
  const double lying = field.settled();
  field.step({.dt = 1e-6, .bit = bit(10.0)});
  CHECK(field.held() > 0.5 * lying);
  CHECK(field.balance_error() < 1e-12);
}

TEST_CASE("debris: bone that comes back takes its chips with it, and leaves those of other bone") {
  DebrisField field = flat_field({.mist_share = 0.0});
  const Vec3i first(20, 20, 18), second(21, 20, 18);
  const auto drill = [&](const Vec3i& voxel) {
    const std::vector<float> gone{0.0f};
    LossSampler sampler(field.site().loss_of({voxel, voxel + 1}, gone), 0.5);
    field.site().set_bone({voxel, voxel + 1}, gone, &sampler);
    DebrisStep now = cutting(0.02, 1.0 * kMm3);
    now.births = sampler.births();
    field.step(now);
    for (int n = 0; n < 50; ++n) field.step({.dt = 0.02, .bit = bit(0.0, 3e-3)});
  };
  drill(first);
  drill(second);
  const double before = field.settled();
  const auto of = [&](const Vec3i& voxel) {
    double sum = 0.0;
    for (const DebrisParticle& one : field.particles()) sum += one.birth.voxel == voxel ? one.volume : 0.0;
    return sum;
  };
  REQUIRE(of(first) > 0.0);  // the bit has taken up the others
  const double kept = of(first);
  const std::vector<float> whole{1.0f};
  field.site().set_bone({second, second + 1}, whole);
  field.bone_came_back();
  CHECK(of(second) == 0.0);
  CHECK(of(first) == doctest::Approx(kept).epsilon(1e-12));
  CHECK(field.totals().undone == doctest::Approx(before - kept).epsilon(1e-9));
  field.site().set_bone({first, first + 1}, whole);
  field.bone_came_back();
  CHECK(field.particles().empty());
  CHECK(field.balance_error() < 1e-12);
}

TEST_CASE("debris: the same calls give the same bits, another seed others; values out of range are refused") {
  const auto bits = [](std::uint64_t seed) {
    const DebrisField field = drilled({.seed = seed});
    Vec3 sum(0.0);
    for (const DebrisParticle& one : field.particles()) sum += one.position;
    return sum;
  };
  CHECK(bits(1) == bits(1));
  CHECK(bits(1) != bits(2));
  const auto refused = [](const DebrisConfig& config) {
    return !DebrisField::create(config, make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)))).ok();
  };
  CHECK_FALSE(refused({}));
  CHECK(refused({.most_particles = 0}));
  CHECK(refused({.particle = 0.0}));
  CHECK(refused({.smallest = 1e-3, .largest = 1e-4}));
  CHECK(refused({.mist_share = 1.1}));
  CHECK(refused({.bulk = std::nan("")}));
}

}  // namespace burrhole::test
