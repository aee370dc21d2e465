// Heat of a hole that is cut into a block: it depends little on the step of conduction, and not on the axis along which the hole lies. The heat of a cell
// that was cut away enters the bone behind it.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/heat/heat_field.h"
#include "tests/support/ablation_twin.h"

namespace burrhole::test {
namespace {

constexpr double kEdge = 0.5e-3, kTick = 0.02, kFeed = 0.33e-3;  // [m], [s], [m/s]: as a perforator in a skull
constexpr double kJoule = 0.5 * 1e8;                             // [J/m^3]: half of 0.1 J/mm^3

struct Hole {
  double radius = 3.1e-3, depth = 5e-3;  // [m]
  double tilt = 0.0;                     // [rad] of its axis in a plane of two axes
  double cone = 0.0;                     // [-] height of the tip's cone over its radius
  int axis = 2;                          // along which it is drilled, downwards
  double fourier = HeatConfig{}.fourier;
};

struct Drilled {
  double kept = 0.0;  // [-] share of the heat that bone holds
  double peak = 0.0;  // [K]
  double unexplained = 0.0;
};

/// Drills a block of 14 x 14 x 7 mm. Places are in axes of the hole, of which the last is turned to `axis`.
Drilled drill(const Hole& hole) {
  const Vec3i across(28, 28, 14);
  const auto turned = [&](const Vec3i& cell) {
    Vec3i out = cell;
    std::swap(out[hole.axis], out[2]);
    return out;
  };
  const Vec3i cells = turned(across);
  HeatConfig config;
  config.fourier = hole.fourier;
  auto made = HeatField::create(config, Vec3(kEdge), {Vec3i(-1), cells + 1});  // air round the block: no heat leaves it
  REQUIRE(made.ok());
  HeatField field = std::move(made).value();
  const VoxelBox block{Vec3i(0), cells};
  std::vector<float> share(block.count(), 1.0f);
  field.set_bone(block, share);
  field.forget_losses();
  const Vec3 way(std::sin(hole.tilt), 0.0, -std::cos(hole.tilt)), entry(7e-3, 7.07e-3, 7e-3);
  const auto ticks = std::lround(hole.depth / (kFeed * kTick));
  for (long n = 1; n <= ticks; ++n) {
    const Vec3 tip = entry + way * (static_cast<double>(n) * kTick * kFeed);
    double lost = 0.0;
    for_each_voxel(block, [&](const Vec3i& cell) {
      const Vec3 from = (Vec3(turned(cell)) + 0.5) * kEdge - tip;
      const double along = glm::dot(from, way), aside = glm::length(from - way * along);
      const double outside = std::max(aside - hole.radius,
                                      (along + aside * hole.cone) / std::sqrt(1.0 + hole.cone * hole.cone));  // [m] about, < 0 in the hole
      const auto left = static_cast<float>(std::clamp(0.5 + outside / kEdge, 0.0, 1.0));
      float& now = share[block.offset_of(cell)];
      if (left < now) lost += static_cast<double>(now - left);
      now = std::min(now, left);
    });
    field.set_bone(block, share);
    field.release(kJoule * lost * std::pow(kEdge, 3.0));
    field.advance(kTick);
  }
  const HeatBalance& b = field.balance();
  return {field.in_bone() / b.input, field.highest_peak(), std::abs(b.input - field.in_bone() - b.chips - b.edge - b.unplaced) / b.input};
}

HeatField full_block(const Vec3& edges, const VoxelBox& cells) {
  auto made = HeatField::create({}, edges, cells);
  REQUIRE(made.ok());
  HeatField field = std::move(made).value();
  field.set_bone(cells, std::vector<float>(cells.count(), 1.0f));
  return field;
}

}  // namespace

// docs/accuracy.md allows 3 %. Before heat entered with the sweep along the axis that the cut faces, it was 9 to 10 %.
TEST_CASE("heat: of a hole, the heat in bone and the hottest cell depend on the step of conduction by at most 3 %") {
  for (const Hole& hole : {Hole{}, Hole{.tilt = 0.3}, Hole{.cone = 0.5}, Hole{.tilt = 0.3, .cone = 0.5}}) {
    Hole fine = hole;
    fine.fourier /= 8.0;
    const Drilled coarse = drill(hole), exact = drill(fine);
    MESSAGE("tilt " << hole.tilt << ", cone " << hole.cone << ": kept " << coarse.kept << ", " << (coarse.kept / exact.kept - 1.0) * 100.0
                    << " %; hottest " << coarse.peak << " K, " << (coarse.peak / exact.peak - 1.0) * 100.0 << " %");
    CHECK(std::abs(coarse.kept / exact.kept - 1.0) < 0.03);
    CHECK(coarse.unexplained < 1e-4);
    CHECK(exact.unexplained < 1e-4);
  }
}

TEST_CASE("heat: a hole along each axis keeps the same heat and has the same hottest cell, though sweeps go along the axes in turns") {
  for (const double radius : {3.1e-3, 0.6e-3}) {  // of 12 and of 2 cells
    const Drilled z = drill({.radius = radius, .axis = 2});
    for (const int axis : {0, 1}) {
      const Drilled other = drill({.radius = radius, .axis = axis});
      MESSAGE("radius " << radius * 1e3 << " mm, axis " << axis << ": kept " << (other.kept / z.kept - 1.0) * 100.0 << " %, hottest "
                        << (other.peak / z.peak - 1.0) * 100.0 << " % of " << z.peak << " K");
      CHECK(std::abs(other.kept / z.kept - 1.0) < 0.03);
      CHECK(std::abs(other.peak / z.peak - 1.0) < 0.03);
    }
  }
}

// A scheme of first order is off by half of v^2 dt / alpha of the heat of chips; one of second order by less than a tenth of that at this step.
TEST_CASE("heat: of a layer that is cut, the heat in bone depends on the step of conduction in second order") {
  for (const double feed : {0.15e-3, 0.33e-3}) {
    const auto column = [&](double fourier) {
      HeatConfig config;
      config.fourier = fourier;
      auto made = HeatField::create(config, Vec3(0.25e-3), {Vec3i(-1), Vec3i(2, 2, 25)});
      REQUIRE(made.ok());
      HeatField field = std::move(made).value();
      const VoxelBox all{Vec3i(0), Vec3i(1, 1, 24)};
      const double seconds = 4.5e-3 / feed, tick = 0.005;
      for (long n = 0; n <= std::lround(seconds / tick); ++n) {
        const double top = (6e-3 - static_cast<double>(n) * tick * feed) / 0.25e-3;  // [cells]
        std::vector<float> share;
        for (int cell = 0; cell < 24; ++cell) share.push_back(static_cast<float>(std::clamp(top - cell, 0.0, 1.0)));
        field.set_bone(all, share);
        if (n == 0) continue;
        field.release(kJoule * feed * tick * std::pow(0.25e-3, 2.0));
        field.advance(tick);
      }
      return field;
    };
    const HeatField coarse = column(HeatConfig{}.fourier), fine = column(HeatConfig{}.fourier / 16.0);
    const double step = coarse.longest_step(), first = 0.5 * feed * feed * step / HeatConfig{}.diffusivity();
    const double error = coarse.in_bone() / fine.in_bone() - 1.0, bound = 0.1 * first * fine.balance().chips / fine.in_bone();
    MESSAGE("feed " << feed * 1e3 << " mm/s: " << error * 100.0 << " %, bound " << bound * 100.0 << " %");
    CHECK(std::abs(error) < bound);
  }
}

TEST_CASE("heat: the heat of a cell that was cut away enters the bone behind it, by the square of the normal's components, and no wall") {
  constexpr double kShort = 2e-3;  // [s]
  constexpr float kThin = 0.05f;   // [-] of a cell: thin, so that chips leave some of the heat
  const double conducted = 5.0 * HeatConfig{}.diffusivity() * kShort / (kEdge * kEdge);  // [-] at most, through five faces
  SUBCASE("the end of a hole of one cell") {
    HeatField field = full_block(Vec3(kEdge), {Vec3i(-3), Vec3i(4)});
    field.set_bone({Vec3i(0), Vec3i(1, 1, 4)}, std::vector<float>{kThin, 0.0f, 0.0f, 0.0f});
    field.forget_losses();
    field.set_bone({Vec3i(0), Vec3i(1)}, std::vector<float>{0.0f});
    field.release(1e-3);
    field.step(kShort);
    const double unit = HeatConfig{}.density * HeatConfig{}.capacity * std::pow(kEdge, 3.0), below = unit * field.rise(Vec3i(0, 0, -1));
    REQUIRE(field.in_bone() > 0.5e-3);
    CHECK(std::abs(below / field.in_bone() - 1.0) < conducted);
    CHECK(field.balance().unplaced == 0.0);
  }
  SUBCASE("a corner of bone in cells of unequal edges") {
    HeatField field = full_block(Vec3(2.0 * kEdge, kEdge, kEdge), {Vec3i(-3), Vec3i(4)});
    const VoxelBox all{Vec3i(-3), Vec3i(4)};
    std::vector<float> share(all.count());
    for_each_voxel(all, [&](const Vec3i& cell) { share[all.offset_of(cell)] = cell.x > 0 || cell.z > 0 ? 0.0f : 1.0f; });
    share[all.offset_of(Vec3i(0))] = kThin;
    field.set_bone(all, share);
    field.forget_losses();
    field.set_bone({Vec3i(0), Vec3i(1)}, std::vector<float>{0.0f});
    field.release(1e-3);
    field.step(kShort);
    // Both axes see the same cells, so the components of the normal are as one over the edges, 1 to 2. Chips take at most half their share of it.
    const double x = field.rise(Vec3i(-1, 0, 0)), z = field.rise(Vec3i(0, 0, -1));
    REQUIRE(x > 0.0);
    CHECK(std::abs(z / x / 4.0 - 1.0) < conducted + 0.5 * static_cast<double>(kThin));
  }
}

}  // namespace burrhole::test
