#include "core/base/box_list.h"

#include <doctest/doctest.h>

#include <type_traits>

#include "core/base/random.h"

using namespace burrhole;

namespace {

static_assert(std::is_trivially_copyable_v<VoxelBoxes>);

/// A box of at most 8 voxels a side within [-20, 20).
VoxelBox random_box(std::uint64_t seed, std::uint64_t n) {
  VoxelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int size = 1 + static_cast<int>(8.0 * uniform01(seed, 6 * n + axis));
    box.lo[axis] = -20 + static_cast<int>((40.0 - size) * uniform01(seed, 6 * n + 3 + axis));
    box.hi[axis] = box.lo[axis] + size;
  }
  return box;
}

bool is(const VoxelBoxes& boxes, const VoxelBox& only) { return boxes.size() == 1 && *boxes.begin() == only; }

/// Pairs of boxes that overlap, and empty boxes.
template <class Boxes>
int faults(const Boxes& boxes) {
  int wrong = 0;
  for (const auto& a : boxes) {
    wrong += a.empty() ? 1 : 0;
    for (const auto& b : boxes) wrong += &a != &b && !a.intersect(b).empty() ? 1 : 0;
  }
  return wrong;
}

}  // namespace

TEST_CASE("BoxList::add: the boxes always cover every voxel added, in at most kMax boxes, and only merging adds voxels") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    VoxelBoxes dirty;
    std::vector<VoxelBox> added;
    VoxelBox hull;
    for (int n = 0; n < 40; ++n) {
      const VoxelBox box = random_box(seed, static_cast<std::uint64_t>(n));
      added.push_back(box);
      hull = hull.unite(box);
      dirty.add(box);
      REQUIRE(dirty.size() <= VoxelBoxes::kMax);
      for (const VoxelBox& known : added) for_each_voxel(known, [&](const Vec3i& v) { REQUIRE(dirty.contains(v)); });
      for (const VoxelBox& known : dirty) REQUIRE(hull.contains(known));
    }
  }
}

TEST_CASE("BoxList::add: up to kMax separate boxes are kept exactly as they came") {
  VoxelBoxes dirty;
  std::size_t voxels = 0;
  for (int n = 0; n < static_cast<int>(VoxelBoxes::kMax); ++n) {
    const VoxelBox box{Vec3i(10 * n, 0, 0), Vec3i(10 * n + 3, 3, 3)};
    dirty.add(box);
    voxels += box.count();
  }
  CHECK(dirty.size() == VoxelBoxes::kMax);
  std::size_t kept = 0;
  for (const VoxelBox& box : dirty) kept += box.count();
  CHECK(kept == voxels);
}

TEST_CASE("BoxList::add: a box inside another and boxes that tile a box merge without adding a voxel") {
  VoxelBoxes dirty;
  dirty.add({Vec3i(0), Vec3i(4, 4, 4)});
  dirty.add({Vec3i(1), Vec3i(3, 3, 3)});
  dirty.add({Vec3i(0), Vec3i(4, 4, 4)});
  CHECK(is(dirty, VoxelBox{Vec3i(0), Vec3i(4, 4, 4)}));
  dirty.add({Vec3i(4, 0, 0), Vec3i(9, 4, 4)});
  CHECK(is(dirty, VoxelBox{Vec3i(0), Vec3i(9, 4, 4)}));
  dirty.add({Vec3i(7, 0, 0), Vec3i(12, 4, 4)});
  CHECK(is(dirty, VoxelBox{Vec3i(0), Vec3i(12, 4, 4)}));
  dirty.add({Vec3i(12, 4, 4), Vec3i(14, 5, 5)});
  CHECK(dirty.size() == 2);
}

TEST_CASE("BoxList::add: one box too many merges the pair whose union wastes least") {
  VoxelBoxes dirty;
  for (int n = 0; n < static_cast<int>(VoxelBoxes::kMax); ++n) dirty.add({Vec3i(100 * n, 0, 0), Vec3i(100 * n + 2, 2, 2)});
  dirty.add({Vec3i(303, 0, 0), Vec3i(305, 2, 2)});  // one voxel away from the fourth
  CHECK(dirty.size() == VoxelBoxes::kMax);
  bool merged = false;
  for (const VoxelBox& box : dirty) {
    merged = merged || box == VoxelBox{Vec3i(300, 0, 0), Vec3i(305, 2, 2)};
    CHECK(box.count() <= 5 * 2 * 2);
  }
  CHECK(merged);
}

TEST_CASE("BoxList::add: empty boxes are nothing, take() empties") {
  VoxelBoxes dirty;
  dirty.add({});
  dirty.add({Vec3i(5), Vec3i(5, 9, 9)});
  dirty.add({Vec3i(5), Vec3i(1, 9, 9)});
  CHECK(dirty.empty());
  dirty.add({Vec3i(0), Vec3i(1)});
  CHECK(dirty.take().size() == 1);
  CHECK(dirty.empty());
  dirty.add({Vec3i(0), Vec3i(1)});
  dirty.clear();
  CHECK(dirty.take().empty());
}

TEST_CASE("BoxList::add_disjoint: boxes never overlap and cover every voxel added; one box too many leaves the box round all") {
  BoxList<VoxelBox, 16> list;
  int collapsed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    list.clear();
    std::vector<VoxelBox> added;
    for (std::uint64_t n = 0; n < 30; ++n) {
      const std::size_t before = list.size();
      added.push_back(random_box(seed, n));
      list.add_disjoint(added.back());
      REQUIRE(list.size() <= 16);
      REQUIRE(faults(list) == 0);
      if (list.size() < before) {
        VoxelBox all;
        for (const VoxelBox& box : added) all = all.unite(box);
        REQUIRE(list.size() == 1);
        CHECK(*list.begin() == all);
        ++collapsed;
      }
      for (const VoxelBox& known : added) for_each_voxel(known, [&](const Vec3i& v) { REQUIRE(list.contains(v)); });
    }
  }
  CHECK(collapsed > 0);
  // Sabotage: the same boxes added as they are do overlap.
  list.clear();
  for (std::uint64_t n = 0; n < 16; ++n) list.append(random_box(1, n));
  CHECK(faults(list) > 0);
}

TEST_CASE("BoxList: prepend, append and erase keep the order; bounds and count are of all boxes") {
  BoxList<VoxelBox, 3> list;
  const auto box = [](int at) { return VoxelBox{Vec3i(at), Vec3i(at + 1)}; };
  list.append(box(1));
  list.append(box(2));
  list.prepend(box(0));
  list.append(box(3));  // one more in passing
  CHECK(list.size() == 4);
  CHECK(list.count() == 4);
  CHECK(list.bounds() == VoxelBox{Vec3i(0), Vec3i(4)});
  list.erase(1);
  CHECK(list.boxes()[0] == box(0));
  CHECK(list.boxes()[1] == box(2));
  CHECK(list.boxes()[2] == box(3));
}

TEST_CASE("append_outside: the parts do not overlap and are the box without the hole") {
  for (std::uint64_t n = 0; n < 500; ++n) {
    CAPTURE(n);
    const VoxelBox box = random_box(7, 2 * n), hole = random_box(7, 2 * n + 1);
    std::vector<VoxelBox> parts;
    append_outside(box, hole, parts);
    std::size_t sum = 0;
    for (const VoxelBox& part : parts) {
      CHECK(box.contains(part));
      CHECK(part.intersect(hole).empty());
      sum += part.count();
    }
    CHECK(faults(parts) == 0);
    CHECK(parts.size() <= 6);
    CHECK(sum == box.count() - box.intersect(hole).count());
  }
}
