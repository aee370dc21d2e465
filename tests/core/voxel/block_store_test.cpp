#include "core/voxel/block_store.h"

#include <doctest/doctest.h>

#include <map>
#include <tuple>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

struct InOrder {
  bool operator()(const Vec3i& a, const Vec3i& b) const { return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x); }
};
using Voxels = std::map<Vec3i, float, InOrder>;  // the plain twin: voxels that are not 1

BlockValues random_values(const Vec3i& block, Voxels& twin, Dice& dice) {
  BlockValues out;
  std::size_t n = 0;
  for_each_voxel(box_of_block(block), [&](const Vec3i& v) {
    const float value = dice.next() < 0.5 ? 1.0f : static_cast<float>(dice.next());
    out[n++] = value;
    twin.erase(v);
    if (value != 1.0f) twin[v] = value;
  });
  return out;
}

void forget(const Vec3i& block, Voxels& twin) {
  for_each_voxel(box_of_block(block), [&](const Vec3i& v) { twin.erase(v); });
}

}  // namespace

TEST_CASE("block store: random blocks put, replaced and erased read back as a map of voxels does, in order, in any box") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    BlockStore store;
    Voxels twin;
    const VoxelBox blocks{Vec3i(-3), Vec3i(3)};
    for (int n = 0; n < 60; ++n) {
      const Vec3i block = dice.box_inside(blocks, 1).lo;
      if (dice.next() < 0.3) {
        store.erase(block);
        forget(block, twin);
        CHECK(store.find(block) == nullptr);
      } else {
        const BlockValues values = random_values(block, twin, dice);
        store.put(block, values);
        REQUIRE(store.find(block) != nullptr);
        CHECK(*store.find(block) == values);
      }
    }
    auto next = twin.begin();
    VoxelBox bounds;
    store.for_each_sorted([&](const Vec3i& v, float value) {
      REQUIRE(next != twin.end());
      REQUIRE(next->first == v);
      REQUIRE(next->second == value);
      bounds.include(v);
      ++next;
    });
    CHECK(next == twin.end());
    CHECK(store.changed_bounds() == bounds);
    for (int n = 0; n < 20; ++n) {
      const VoxelBox box = dice.box_inside({Vec3i(-30), Vec3i(30)}, 25);
      std::vector<float> read(box.count());
      store.read_box(box, read);
      std::size_t at = 0;
      for_each_voxel(box, [&](const Vec3i& v) {
        const auto known = twin.find(v);
        REQUIRE(read[at++] == (known == twin.end() ? 1.0f : known->second));
      });
    }
    store.clear();
    CHECK(store.changed_bounds().empty());
  }
}

TEST_CASE("block store: within what was reserved its memory does not grow, and erased blocks are used again") {
  BlockStore store;
  store.reserve(100);
  const std::size_t bytes = store.bytes();
  BlockValues values{};
  for (int round = 0; round < 3; ++round) {
    for (int n = 0; n < 100; ++n) store.put({n, round, -n}, values);
    CHECK(store.size() == 100);
    CHECK(store.bytes() == bytes);
    for (int n = 0; n < 100; ++n) store.erase({n, round, -n});
  }
}

TEST_CASE("block marks: the blocks that the marked boxes touch, each once, sorted, and none afterwards") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Dice dice{seed};
    const VoxelBox window = random_window({Vec3i(-40), Vec3i(40)}, dice).grown(20);
    BlockMarks marks;
    marks.reset(window);
    std::map<Vec3i, float, InOrder> expected;
    for (int n = 0; n < 6; ++n) {
      const VoxelBox box = dice.box_inside(window, 12);
      marks.mark(box);
      for_each_voxel(box, [&](const Vec3i& v) { expected[block_of(v)] = 1.0f; });
    }
    auto next = expected.begin();
    marks.take([&](const Vec3i& block) {
      REQUIRE(next != expected.end());
      CHECK(next->first == block);
      ++next;
    });
    CHECK(next == expected.end());
    CHECK(marks.empty());
    marks.take([](const Vec3i&) { FAIL("a mark was left"); });
  }
}
