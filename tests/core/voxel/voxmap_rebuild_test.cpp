#include <doctest/doctest.h>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

// Equality here is bit for bit: the same float product and differences, in any order, round the same way.

namespace {

constexpr std::uint64_t kSeeds = 8;
const Vec3i kDims(27, 22, 19);  // no multiple of a leaf's 8

/// Sabotage: gradients kept from before, made anew in the touched box only.
bool halo_matters(const MasterWindow& before, const MasterWindow& after, const VoxelBox& touched) {
  std::vector<Vec3f> kept = gradients_of(before);
  derive_gradient(after, touched, kept);
  return kept != gradients_of(after);
}

}  // namespace

TEST_CASE("Voxmap: after random erosion and slides the window equals a full rebuild bit for bit, and a forgotten halo is caught") {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const DenseBone dense = random_bone(kDims, seed);
    const float dead_zone = seed % 2 == 0 ? 0.08f : 0.0f;
    Voxmap voxmap = make_voxmap(load_bone(dense), dead_zone);
    PlainTwin twin(dense, dead_zone);
    int halo_misses = 0;
    for (int slide = 0; slide < 8; ++slide) {
      REQUIRE(voxmap.place_window(random_window(voxmap.bone().bounds(), dice)).ok());
      REQUIRE(difference(voxmap.window(), twin) == "");
      for (int bite = 0; bite < 5; ++bite) {
        const VoxelBox touched = dice.box_inside(voxmap.window().erodible_box(), 6);
        const MasterWindow before = voxmap.window();
        erode_box(voxmap, twin, touched, dice);
        REQUIRE(difference(voxmap.window(), twin) == "");
        halo_misses += halo_matters(before, voxmap.window(), touched) ? 1 : 0;
      }
    }
    CHECK(halo_misses > 0);
  }
}

TEST_CASE("Voxmap: dirty boxes cover every voxel whose density or gradient changed, for listeners at their own pace") {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    CAPTURE(seed);
    Dice dice{seed + 100};
    const DenseBone dense = random_bone(kDims, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    REQUIRE(voxmap.place_window({Vec3i(-2), Vec3i(25, 21, 20)}).ok());
    const std::size_t eager = voxmap.add_listener(), lazy = voxmap.add_listener();
    MasterWindow eager_saw = voxmap.window(), lazy_saw = voxmap.window();
    int caught = 0;
    for (int bite = 0; bite < 40; ++bite) {
      const VoxelBox touched = dice.box_inside(voxmap.window().erodible_box(), 5);
      erode_box(voxmap, twin, touched, dice);
      REQUIRE(uncovered_change(eager_saw, voxmap.window(), voxmap.take_dirty(eager)) == "");
      caught += uncovered_change(eager_saw, voxmap.window(), std::span(&touched, 1)).empty() ? 0 : 1;  // sabotage: boxes without their halo
      eager_saw = voxmap.window();
      if (dice.next() < 0.1) {
        REQUIRE(uncovered_change(lazy_saw, voxmap.window(), voxmap.take_dirty(lazy)) == "");
        lazy_saw = voxmap.window();
      }
    }
    CHECK(voxmap.take_dirty(eager).empty());
    CHECK(caught > 0);
  }
}

TEST_CASE("Voxmap: dense reads from store and window together equal a full rebuild, inside and outside window and grid") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Dice dice{seed + 200};
    const DenseBone dense = random_bone(kDims, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    const VoxelBox all = voxmap.bone().bounds().grown(3);
    std::vector<float> remaining(all.count()), density(all.count());
    std::vector<Vec3f> gradient(all.count());
    for (int slide = 0; slide < 6; ++slide) {
      REQUIRE(voxmap.place_window(random_window(voxmap.bone().bounds(), dice)).ok());
      erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 9), dice);
      voxmap.read_remaining(all, remaining);
      voxmap.read_density(all, density);
      voxmap.read_gradient(all, gradient);
      std::size_t n = 0;
      for_each_voxel(all, [&](const Vec3i& v) {
        REQUIRE(remaining[n] == twin.remaining(v));
        REQUIRE(density[n] == twin.density(v));
        REQUIRE(gradient[n] == twin.gradient(v));
        ++n;
      });
    }
  }
}

TEST_CASE("Voxmap: the dead zone is part of the window, so another one gives other gradients") {
  const DenseBone dense = random_bone({12, 12, 12}, 3);
  Voxmap voxmap = make_voxmap(load_bone(dense), 0.4f);
  REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
  CHECK(difference(voxmap.window(), PlainTwin(dense, 0.4f)) == "");
  CHECK(difference(voxmap.window(), PlainTwin(dense, 0.0f)) != "");
}
