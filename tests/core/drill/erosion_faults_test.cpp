#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPitch = 0.5e-3;

bool refuses(const ErosionConfig& config, const ErosionPoints& points) {
  const auto erosion = Erosion::create(config, points);
  return !erosion.ok() && erosion.error().code == ErrorCode::out_of_range && !erosion.error().message.empty();
}

ErosionPoints one_point() { return {.pitch = kPitch, .positions = {Vec3(0.0)}, .factors = {1.0f}}; }

}  // namespace

TEST_CASE("erosion: create refuses thresholds, sub-steps and points outside their range, and takes their bounds") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float minimum : {-0.01f, 0.5f, 2.0f, nan}) CHECK(refuses({.minimum_density = minimum}, one_point()));
  for (const double longest : {0.0, -1.0, 1.001, std::nan("")}) CHECK(refuses({.longest_substep = longest}, one_point()));
  const auto spoilt = [](auto&& spoil) {
    ErosionPoints points = one_point();
    spoil(points);
    return refuses({}, points);
  };
  CHECK(spoilt([](ErosionPoints& p) { p.factors.clear(); }));
  CHECK(spoilt([](ErosionPoints& p) { p.factors.push_back(1.0f); }));
  CHECK(spoilt([](ErosionPoints& p) { p.factors[0] = -1.0f; }));
  CHECK(spoilt([nan](ErosionPoints& p) { p.factors[0] = nan; }));
  CHECK(spoilt([](ErosionPoints& p) { p.factors[0] = std::numeric_limits<float>::infinity(); }));
  CHECK(spoilt([](ErosionPoints& p) { p.positions[0].y = std::nan(""); }));
  CHECK(spoilt([](ErosionPoints& p) { p.pitch = 0.0; }));
  CHECK(spoilt([](ErosionPoints& p) { p.pitch = std::nan(""); }));
  CHECK(spoilt([](ErosionPoints& p) { p.pitch = std::numeric_limits<double>::infinity(); }));
  CHECK_FALSE(refuses({.minimum_density = 0.0f, .longest_substep = 1.0}, one_point()));
  CHECK_FALSE(refuses({}, {}));
}

TEST_CASE("erosion: points outside the erodible box are counted, once a sub-step, and nothing there changes") {
  for (const ErosionLaw law : {ErosionLaw::rate, ErosionLaw::per_update}) {
    Voxmap voxmap = Block{.dims = Vec3i(20), .pitch = kPitch}.make();
    REQUIRE(voxmap.place_window({Vec3i(3), Vec3i(15)}).ok());
    const ErosionPoints points = lattice(Ball{1.6e-3}, 0.25e-3, 1e9f);
    Erosion erosion = make_erosion(points, {.law = law});
    const VoxelBox allowed = voxmap.window().erodible_box();
    std::uint64_t expected = 0;
    for (const double x : {1.3, 6.1, 13.7, 30.2, -200.0}) {
      const Affine pose = turned_pose(kPitch, Vec3(x, 8.2, 6.4), 5);
      std::uint64_t outside = 0;
      for (const Vec3& p : points.positions) outside += allowed.contains(Vec3i(glm::floor(pose * p + 0.5))) ? 0 : 1;
      const ErosionOutcome outcome = erosion.step(voxmap, {pose, pose}, 1.0, 1e-3);
      voxmap.commit(outcome.changed);
      CHECK(outcome.outside == outside);
      CHECK(allowed.contains(outcome.changed.bounds()));
      expected += outside;
    }
    CHECK(expected > 0);
    CHECK(allowed.contains(voxmap.changed_bounds()));
    CHECK_FALSE(voxmap.changed_bounds().empty());
  }
}

TEST_CASE("erosion: a path along which every point leaves the window counts every point of every sub-step") {
  Voxmap voxmap = Block{.dims = Vec3i(10), .pitch = kPitch}.make();
  const ErosionPoints points = lattice(Ball{0.8e-3}, 0.25e-3, 1.0f);
  Erosion erosion = make_erosion(points);
  const ErosionPath path{upright_pose(kPitch, Vec3(40.0, 5.0, 5.0)), upright_pose(kPitch, Vec3(46.0, 5.0, 5.0))};
  const ErosionOutcome outcome = erosion.step(voxmap, path, 10.0, 1e-3);
  CHECK(outcome.substeps == 12);
  CHECK(outcome.outside == 12 * points.size());
  CHECK(outcome.removed_mass == 0.0);
}

TEST_CASE("erosion: the tool that slides to another window erodes there as a fresh one would") {
  const ErosionPoints points = lattice(Ball{1.2e-3}, 0.25e-3, 1.0f);
  const Affine pose = turned_pose(kPitch, Vec3(18.0, 17.0, 16.0), 2);
  Voxmap slid = Block{.dims = Vec3i(24), .pitch = kPitch}.make(), fresh = Block{.dims = Vec3i(24), .pitch = kPitch}.make();
  Erosion used = make_erosion(points), unused = make_erosion(points);
  REQUIRE(slid.place_window({Vec3i(0), Vec3i(12)}).ok());
  const Affine first = turned_pose(kPitch, Vec3(4.0), 1);
  slid.commit(used.step(slid, {first, first}, 300.0, 1e-3).changed);
  REQUIRE(slid.place_window({Vec3i(10), Vec3i(26)}).ok());
  for (Voxmap* voxmap : {&slid, &fresh}) {
    Erosion& erosion = voxmap == &slid ? used : unused;
    voxmap->commit(erosion.step(*voxmap, {pose, pose}, 300.0, 1e-3).changed);
  }
  const VoxelBox there{Vec3i(12), Vec3i(24)};
  std::vector<float> a(there.count()), b(there.count());
  slid.read_remaining(there, a);
  fresh.read_remaining(there, b);
  CHECK(a == b);
  CHECK(fresh.changed_bounds().count() > 20);
}
