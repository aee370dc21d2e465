#include <doctest/doctest.h>

#include <cmath>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

DenseBone plain_bone(const Vec3i& dims) {
  DenseBone dense = random_bone(dims, 1);
  std::fill(dense.occupancy.begin(), dense.occupancy.end(), 1.0f);
  return dense;
}

float& left_at(Voxmap& voxmap, const Vec3i& v) { return voxmap.remaining()[voxmap.window().box.offset_of(v)]; }

void write_voxel(Voxmap& voxmap, const Vec3i& v, float value) {
  left_at(voxmap, v) = value;
  voxmap.commit({v, v + 1});
}

float read_voxel(Voxmap& voxmap, const Vec3i& v) {
  float value = -1.0f;
  voxmap.read_remaining({v, v + 1}, {&value, 1});
  return value;
}

/// Writes one value a voxel, each through a window round it.
void write_through_windows(Voxmap& voxmap, const std::vector<Vec3i>& voxels, int reach) {
  float value = 0.1f;
  for (const Vec3i& v : voxels) {
    REQUIRE(voxmap.place_window({v - reach, v + reach + 1}).ok());
    write_voxel(voxmap, v, value);
    value += 0.01f;
  }
}

}  // namespace

TEST_CASE("Voxmap: what was written is read back at leaf boundaries, negative indices and outside the grid, before and after slides") {
  Voxmap voxmap = make_voxmap(load_bone(plain_bone({20, 20, 20})));
  const std::vector<Vec3i> voxels{{7, 7, 7},    {8, 8, 8},    {7, 8, 7},   {0, 0, 0},     {-1, -1, -1}, {-8, -8, -8},    {-9, 0, 5},
                                  {19, 19, 19}, {20, 20, 20}, {24, 3, -7}, {-17, 15, 16}, {15, 16, 23}, {1000, -1000, 5}};
  float value = 0.1f;
  for (const Vec3i& v : voxels) {
    REQUIRE(voxmap.place_window({v - 3, v + 4}).ok());
    write_voxel(voxmap, v, value);
    CHECK(read_voxel(voxmap, v) == value);
    REQUIRE(voxmap.place_window({Vec3i(40), Vec3i(50)}).ok());
    CHECK(read_voxel(voxmap, v) == value);
    REQUIRE(voxmap.place_window({v - 2, v + 3}).ok());
    CHECK(left_at(voxmap, v) == value);
    value += 0.03125f;
  }
  std::size_t changed = 0;
  std::vector<float> all(VoxelBox{Vec3i(-30), Vec3i(50)}.count());
  voxmap.read_remaining({Vec3i(-30), Vec3i(50)}, all);
  for (const float left : all) changed += left != 1.0f ? 1 : 0;
  CHECK(changed == voxels.size() - 1);  // the last one lies far off
}

TEST_CASE("Voxmap: a voxel grown back to 1 counts as never touched, a voxel emptied stays emptied") {
  Voxmap voxmap = make_voxmap(load_bone(plain_bone({12, 12, 12})));
  REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
  const std::uint64_t untouched = voxmap.hash();
  write_voxel(voxmap, {5, 5, 5}, 0.25f);
  CHECK(voxmap.hash() != untouched);
  CHECK(voxmap.changed_bounds() == VoxelBox{Vec3i(5), Vec3i(6)});
  write_voxel(voxmap, {5, 5, 5}, 1.0f);
  CHECK(voxmap.hash() == untouched);
  CHECK(voxmap.changed_bounds().empty());
  write_voxel(voxmap, {5, 5, 5}, 0.0f);
  CHECK(read_voxel(voxmap, {5, 5, 5}) == 0.0f);
  CHECK(voxmap.hash() != untouched);
}

TEST_CASE("Voxmap: the hash does not depend on the windows through which, nor on the order in which, bone was written") {
  const DenseBone dense = plain_bone({24, 24, 24});
  const std::vector<Vec3i> voxels{{3, 4, 5}, {8, 8, 8}, {7, 8, 8}, {16, 2, 20}, {20, 20, 3}};
  Voxmap by_windows = make_voxmap(load_bone(dense));
  write_through_windows(by_windows, voxels, 3);
  Voxmap by_wide_windows = make_voxmap(load_bone(dense));
  write_through_windows(by_wide_windows, voxels, 9);

  Voxmap backwards = make_voxmap(load_bone(dense));
  REQUIRE(backwards.place_window(VoxelBox{Vec3i(0), Vec3i(24)}.grown(2)).ok());
  for (std::size_t n = voxels.size(); n-- > 0;) {
    float value = 0.1f;  // the same running sum of floats as going forwards
    for (std::size_t m = 0; m < n; ++m) value += 0.01f;
    write_voxel(backwards, voxels[n], value);
  }
  CHECK(by_windows.hash() == by_wide_windows.hash());
  CHECK(by_windows.hash() == backwards.hash());

  // One bit of one voxel, and the same value one voxel further, are two other hashes.
  const std::uint64_t before = backwards.hash();
  const float value = left_at(backwards, {8, 8, 8});
  write_voxel(backwards, {8, 8, 8}, std::nextafter(value, 1.0f));
  CHECK(backwards.hash() != before);
  write_voxel(backwards, {8, 8, 8}, 1.0f);
  write_voxel(backwards, {9, 8, 8}, value);
  CHECK(backwards.hash() != before);
}

TEST_CASE("Voxmap: write_back, reads and the hash itself change neither hash, window nor epochs") {
  const DenseBone dense = random_bone({20, 20, 20}, 4);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  PlainTwin twin(dense, 0.08f);
  Dice dice{4};
  REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
  erode_box(voxmap, twin, {Vec3i(3), Vec3i(15)}, dice);
  const std::uint64_t hash = voxmap.hash(), window_epoch = voxmap.window_epoch(), growth_epoch = voxmap.growth_epoch();
  voxmap.write_back();
  voxmap.write_back();
  CHECK(voxmap.hash() == hash);
  CHECK(difference(voxmap.window(), twin) == "");
  CHECK(voxmap.window_epoch() == window_epoch);
  CHECK(voxmap.growth_epoch() == growth_epoch);
}

TEST_CASE("Voxmap: place_window raises the window epoch and refuses sizes outside its limits with the numbers, keeping the old window") {
  Voxmap voxmap = make_voxmap(load_bone(plain_bone({12, 12, 12})));
  REQUIRE(voxmap.place_window({Vec3i(0), Vec3i(10)}).ok());
  const std::uint64_t epoch = voxmap.window_epoch();
  for (const Vec3i& size : {Vec3i(4, 10, 10), Vec3i(10, 4, 10), Vec3i(10, 10, 4), Vec3i(513, 10, 10), Vec3i(10, 10, 600),
                            Vec3i(257, 256, 256), Vec3i(0), Vec3i(-7)}) {
    CAPTURE(size.x);
    const Status status = voxmap.place_window({Vec3i(1), Vec3i(1) + size});
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().code == ErrorCode::out_of_range);
    for (const int edge : {size.x, size.y, size.z, 5, 512, 16777216})
      CHECK(status.error().message.find(std::to_string(edge)) != std::string::npos);
  }
  CHECK(voxmap.window().box == VoxelBox{Vec3i(0), Vec3i(10)});
  CHECK(voxmap.window_epoch() == epoch);
  REQUIRE(voxmap.place_window({Vec3i(-3), Vec3i(2, 2, 2)}).ok());
  CHECK(voxmap.window_epoch() > epoch);
  CHECK(voxmap.place_window({Vec3i(0), Vec3i(512, 5, 5)}).ok());
}

TEST_CASE("Voxmap: create refuses a dead zone below 0, at 0.5 or above") {
  const auto bone = load_bone(plain_bone({6, 6, 6}));
  for (const float dead_zone : {-0.01f, 0.5f, 1.0f, std::nanf("")})
    CHECK_FALSE(Voxmap::create(bone, {.gradient_dead_zone = dead_zone}).ok());
  for (const float dead_zone : {0.0f, 0.49f}) CHECK(Voxmap::create(bone, {.gradient_dead_zone = dead_zone}).ok());
}

TEST_CASE("Voxmap: a window that slid, by any way and size, equals one loaded there, bit for bit") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const Vec3i dims(26, 24, 22);
    const DenseBone dense = random_bone(dims, seed);
    Voxmap slid = make_voxmap(load_bone(dense)), loaded = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    REQUIRE(slid.place_window({Vec3i(0), Vec3i(16)}).ok());
    for (int step = 0; step < 40; ++step) {
      const VoxelBox bite = dice.box_inside(slid.window().erodible_box(), 4);
      erode_box(slid, twin, bite, dice);
      // The other goes far away and comes back each time, so nothing can be kept.
      REQUIRE(loaded.place_window(slid.window().box).ok());
      for_each_voxel(bite, [&](const Vec3i& v) {
        const std::size_t at = slid.window().box.offset_of(v);
        loaded.remaining()[at] = slid.window().remaining[at];
      });
      loaded.commit(bite);
      const Vec3i shift(dice.next_below(9) - 4, dice.next_below(7) - 3, dice.next_below(9) - 4);
      const Vec3i wider(dice.next() < 0.3 ? 2 : 0, 0, dice.next() < 0.2 ? 1 : 0);
      VoxelBox box{slid.window().box.lo + shift, slid.window().box.hi + shift + wider};
      if (!box.grown(-4).intersect({Vec3i(0), dims}).empty() && box.size().x < 24) {
        REQUIRE(slid.place_window(box).ok());
      } else {
        box = {Vec3i(2), Vec3i(18)};
        REQUIRE(slid.place_window(box).ok());
      }
      REQUIRE(loaded.place_window({Vec3i(400), Vec3i(408)}).ok());
      REQUIRE(loaded.place_window(box).ok());
      const MasterWindow &a = slid.window(), &b = loaded.window();
      CHECK(a.box == b.box);
      CHECK(a.occupancy == b.occupancy);
      CHECK(a.hardness == b.hardness);
      CHECK(a.remaining == b.remaining);
      CHECK(a.density == b.density);
      CHECK(gradients_of(a) == gradients_of(b));
    }
    CHECK(slid.hash() == loaded.hash());
  }
}
