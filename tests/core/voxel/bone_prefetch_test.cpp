#include "core/voxel/bone_prefetch.h"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(60, 52, 45);

Vec3i random_shift(Dice& dice, int most) {
  const auto one = [&] { return dice.next_below(2 * most + 1) - most; };
  return {one(), one(), one()};
}

void fill_all(BonePrefetch& prefetch) {
  while (prefetch.fill(64) > 0) continue;
}

/// A window of about 26 voxels an edge at a random place near the bone.
VoxelBox start_window(Dice& dice) {
  const Vec3i lo = random_shift(dice, 10);
  return {lo, lo + 24 + Vec3i(dice.next_below(5), dice.next_below(5), dice.next_below(5))};
}

}  // namespace

TEST_CASE("bone prefetch: slides within what is read ahead miss nothing, and the window equals that of a voxmap that reads OpenVDB") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const DenseBone dense = random_bone(kDims, seed);
    const auto bone = load_bone(dense);
    Voxmap ahead = make_voxmap(bone), plain = make_voxmap(bone);
    PlainTwin twin(dense, 0.08f);
    BonePrefetch prefetch(*bone);
    VoxelBox box = start_window(dice);
    REQUIRE(ahead.place_window(box).ok());
    ahead.set_prefetch(&prefetch);
    for (int slide = 0; slide < 40; ++slide) {
      fill_all(prefetch);
      const Vec3i shift = random_shift(dice, 6), wider = glm::abs(random_shift(dice, 2));
      box = {box.lo + shift, box.hi + shift + wider};
      if (box.size().x > 34) box.hi = box.lo + 24;  // smaller again
      REQUIRE(ahead.place_window(box).ok());
      REQUIRE(plain.place_window(box).ok());
      REQUIRE(ahead.window().occupancy == plain.window().occupancy);
      REQUIRE(ahead.window().hardness == plain.window().hardness);
      if (twin.reach().contains(box)) erode_box(ahead, twin, dice.box_inside(box.grown(-2), 9), dice);
      if (twin.reach().contains(box)) REQUIRE(difference(ahead.window(), twin) == "");
      std::vector<float> left(box.count());
      ahead.read_remaining(box, left);
      std::ranges::copy(left, plain.remaining().begin());
      plain.commit(box.grown(-2));
    }
    CHECK(prefetch.hits() > 1000);
    CHECK(prefetch.misses() == 0);
  }
}

TEST_CASE("bone prefetch: what was not read ahead is read at once and counted: nothing filled, or a leap too far") {
  const DenseBone dense = random_bone(kDims, 7);
  const auto bone = load_bone(dense);
  Voxmap voxmap = make_voxmap(bone);
  const PlainTwin twin(dense, 0.08f);
  BonePrefetch prefetch(*bone);
  REQUIRE(voxmap.place_window({Vec3i(0), Vec3i(24)}).ok());
  voxmap.set_prefetch(&prefetch);
  REQUIRE(voxmap.place_window({Vec3i(5), Vec3i(29)}).ok());
  CHECK(prefetch.hits() == 0);
  CHECK(prefetch.misses() > 0);
  CHECK(difference(voxmap.window(), twin) == "");
  fill_all(prefetch);
  std::uint64_t before = prefetch.misses();
  REQUIRE(voxmap.place_window({Vec3i(5, 5, 26), Vec3i(29, 29, 50)}).ok());
  CHECK(prefetch.hits() > 0);
  CHECK(prefetch.misses() > before);
  CHECK(difference(voxmap.window(), twin) == "");
  before = prefetch.misses();
  REQUIRE(voxmap.place_window({Vec3i(60), Vec3i(70)}).ok());
  CHECK(prefetch.misses() > before);
}

TEST_CASE("bone prefetch: labels of a slide's new parts and a voxel round them come from it, and equal the bone's") {
  const DenseBone dense = random_bone(kDims, 3);
  const auto bone = load_bone(dense);
  Voxmap voxmap = make_voxmap(bone);
  BonePrefetch prefetch(*bone, true);
  const VoxelBox from{Vec3i(3, 4, 5), Vec3i(30, 31, 32)};
  REQUIRE(voxmap.place_window(from).ok());
  voxmap.set_prefetch(&prefetch);
  fill_all(prefetch);
  for (const VoxelBox& part : {VoxelBox{{30, 4, 5}, {36, 31, 32}}, VoxelBox{{3, 4, -1}, {30, 31, 5}}}) {
    const VoxelBox wide = part.grown(1);
    std::vector<float> read(wide.count()), expected(wide.count());
    voxmap.read_labels(wide, read);
    bone->read_labels(wide, expected);
    CHECK(read == expected);
  }
  CHECK(prefetch.misses() == 0);
}

TEST_CASE("bone prefetch: blocks behind the window are used again, so its memory does not grow along a way") {
  const auto bone = load_bone(random_bone(kDims, 5));
  BonePrefetch prefetch(*bone);
  std::size_t most = 0;
  for (int n = 0; n < 200; ++n) {
    prefetch.aim({Vec3i(n), Vec3i(n + 24)});
    fill_all(prefetch);
    if (n == 20) most = prefetch.bytes();
  }
  CHECK(prefetch.bytes() <= most * 11 / 10);  // 24 voxels and the shell touch 6 or 7 blocks an edge, in the first 20 steps as later
}

TEST_CASE("bone prefetch: filled by another thread while the window slides, the window is as read from OpenVDB") {
  Dice dice{11};
  const auto bone = load_bone(random_bone(kDims, 11));
  Voxmap ahead = make_voxmap(bone), plain = make_voxmap(bone);
  BonePrefetch prefetch(*bone);
  VoxelBox box = start_window(dice);
  REQUIRE(ahead.place_window(box).ok());
  ahead.set_prefetch(&prefetch);
  std::atomic<bool> stop{false};
  std::thread other([&] {
    while (!stop.load()) prefetch.fill(16);
  });
  for (int slide = 0; slide < 400; ++slide) {
    const Vec3i shift = random_shift(dice, 4);
    box = {box.lo + shift, box.hi + shift};
    if (!bone->bounds().grown(40).contains(box)) box = start_window(dice);
    const bool both = ahead.place_window(box).ok() && plain.place_window(box).ok();
    if (!both || ahead.window().occupancy != plain.window().occupancy || ahead.window().hardness != plain.window().hardness) {
      stop = true;
      other.join();
      FAIL("the window differs after slide ", slide);
    }
  }
  stop = true;
  other.join();
  CHECK(prefetch.hits() + prefetch.misses() > 400);
}
