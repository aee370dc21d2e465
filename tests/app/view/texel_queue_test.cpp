// Boxes that wait for a budget, against voxels marked one by one.
#include "app/view/texel_queue.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <utility>

using namespace burrhole;

namespace {

constexpr VoxelBox kAll{{0, 0, 0}, {24, 20, 16}};

VoxelBox random_box(std::mt19937& random, int longest) {
  const auto number = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(random); };
  const Vec3i lo(number(0, 23), number(0, 19), number(0, 15));
  return VoxelBox{lo, lo + Vec3i(number(1, longest), number(1, longest), number(1, longest))}.intersect(kAll);
}

}  // namespace

TEST_CASE("texel queue: all that changed is handed out once, within the budget") {
  const unsigned seed = 4711;
  MESSAGE("seed " << seed);
  std::mt19937 random(seed);
  for (const std::size_t most : {std::size_t{1}, std::size_t{7}, std::size_t{100}, std::size_t{1000}, std::size_t{100'000}}) {
    TexelQueue queue;
    std::vector<int> waiting(kAll.count(), 0);
    for (int frame = 0; frame < 300; ++frame) {
      if (frame < 40 && frame % 3 == 0) {
        const VoxelBox box = random_box(random, 8);
        queue.add(box);
        for_each_voxel(box, [&](const Vec3i& v) { waiting[kAll.offset_of(v)] = 1; });
      }
      const std::size_t before = queue.texels();
      std::size_t taken = 0, longest_row = 0;
      for (const VoxelBox& box : queue.take(most)) {
        REQUIRE_FALSE(box.empty());
        taken += box.count();
        longest_row = std::max(longest_row, static_cast<std::size_t>(box.size().x));
        // Once each: what was handed out waits no longer.
        for_each_voxel(box, [&](const Vec3i& v) { REQUIRE(std::exchange(waiting[kAll.offset_of(v)], 0) == 1); });
      }
      REQUIRE(taken <= std::max(most, longest_row));
      REQUIRE(queue.texels() == before - taken);
      REQUIRE((taken > 0) == (before > 0));
    }
    while (!queue.empty())
      for (const VoxelBox& box : queue.take(most))
        for_each_voxel(box, [&](const Vec3i& v) { REQUIRE(std::exchange(waiting[kAll.offset_of(v)], 0) == 1); });
    CHECK(std::ranges::count(waiting, 1) == 0);
  }
}

TEST_CASE("texel queue: boxes that overlap wait once, and too many wait as one") {
  TexelQueue queue;
  queue.add({{0, 0, 0}, {10, 10, 10}});
  queue.add({{5, 5, 5}, {15, 15, 15}});
  CHECK(queue.texels() == 1000u + 1000u - 125u);
  queue.add({{2, 2, 2}, {9, 9, 9}});
  CHECK(queue.texels() == 1875u);
  TexelQueue many;
  for (int n = 0; n <= static_cast<int>(TexelQueue::kMostBoxes); ++n) many.add({{3 * n, 0, 0}, {3 * n + 1, 1, 1}});
  const std::vector<VoxelBox> all = many.take(1'000'000);
  REQUIRE(all.size() == 1);
  CHECK(all[0] == VoxelBox{{0, 0, 0}, {3 * static_cast<int>(TexelQueue::kMostBoxes) + 1, 1, 1}});
  CHECK(many.empty());
}

TEST_CASE("texel queue: the budget parts a box by slabs, then by rows, and never below a row") {
  TexelQueue queue;
  queue.add({{0, 0, 0}, {10, 6, 4}});
  CHECK(queue.take(125) == std::vector{VoxelBox{{0, 0, 0}, {10, 6, 2}}});
  CHECK(queue.take(25) == std::vector{VoxelBox{{0, 0, 2}, {10, 2, 3}}});
  CHECK(queue.take(3) == std::vector{VoxelBox{{0, 2, 2}, {10, 3, 3}}});
  CHECK(queue.take(1000) == std::vector{VoxelBox{{0, 3, 2}, {10, 6, 3}}, VoxelBox{{0, 0, 3}, {10, 6, 4}}});
}
