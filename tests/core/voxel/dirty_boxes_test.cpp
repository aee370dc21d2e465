#include "core/voxel/dirty_boxes.h"

#include <doctest/doctest.h>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

bool covers(const std::vector<VoxelBox>& boxes, const Vec3i& v) {
  for (const VoxelBox& box : boxes)
    if (box.contains(v)) return true;
  return false;
}

}  // namespace

TEST_CASE("DirtyBoxes: always cover every voxel added, in at most kMax boxes, and only merging adds voxels") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    DirtyBoxes dirty;
    std::vector<VoxelBox> added;
    VoxelBox hull;
    for (int n = 0; n < 40; ++n) {
      const VoxelBox box = dice.box_inside({Vec3i(-20), Vec3i(20)}, 8);
      added.push_back(box);
      hull = hull.unite(box);
      dirty.add(box);
      REQUIRE(dirty.boxes().size() <= DirtyBoxes::kMax);
      for (const VoxelBox& known : added) for_each_voxel(known, [&](const Vec3i& v) { REQUIRE(covers(dirty.boxes(), v)); });
      for (const VoxelBox& known : dirty.boxes()) REQUIRE(hull.contains(known));
    }
  }
}

TEST_CASE("DirtyBoxes: up to kMax separate boxes are kept exactly as they came") {
  DirtyBoxes dirty;
  std::size_t voxels = 0;
  for (int n = 0; n < static_cast<int>(DirtyBoxes::kMax); ++n) {
    const VoxelBox box{Vec3i(10 * n, 0, 0), Vec3i(10 * n + 3, 3, 3)};
    dirty.add(box);
    voxels += box.count();
  }
  CHECK(dirty.boxes().size() == DirtyBoxes::kMax);
  std::size_t kept = 0;
  for (const VoxelBox& box : dirty.boxes()) kept += box.count();
  CHECK(kept == voxels);
}

TEST_CASE("DirtyBoxes: a box inside another and boxes that tile a box merge without adding a voxel") {
  DirtyBoxes dirty;
  dirty.add({Vec3i(0), Vec3i(4, 4, 4)});
  dirty.add({Vec3i(1), Vec3i(3, 3, 3)});
  dirty.add({Vec3i(0), Vec3i(4, 4, 4)});
  CHECK(dirty.boxes() == std::vector<VoxelBox>{{Vec3i(0), Vec3i(4, 4, 4)}});
  dirty.add({Vec3i(4, 0, 0), Vec3i(9, 4, 4)});
  CHECK(dirty.boxes() == std::vector<VoxelBox>{{Vec3i(0), Vec3i(9, 4, 4)}});
  dirty.add({Vec3i(7, 0, 0), Vec3i(12, 4, 4)});
  CHECK(dirty.boxes() == std::vector<VoxelBox>{{Vec3i(0), Vec3i(12, 4, 4)}});
  dirty.add({Vec3i(12, 4, 4), Vec3i(14, 5, 5)});
  CHECK(dirty.boxes().size() == 2);
}

TEST_CASE("DirtyBoxes: one box too many merges the pair whose union wastes least") {
  DirtyBoxes dirty;
  for (int n = 0; n < static_cast<int>(DirtyBoxes::kMax); ++n) dirty.add({Vec3i(100 * n, 0, 0), Vec3i(100 * n + 2, 2, 2)});
  dirty.add({Vec3i(303, 0, 0), Vec3i(305, 2, 2)});  // one voxel away from the fourth
  CHECK(dirty.boxes().size() == DirtyBoxes::kMax);
  bool merged = false;
  for (const VoxelBox& box : dirty.boxes()) {
    merged = merged || box == VoxelBox{Vec3i(300, 0, 0), Vec3i(305, 2, 2)};
    CHECK(box.count() <= 5 * 2 * 2);
  }
  CHECK(merged);
}

TEST_CASE("DirtyBoxes: empty boxes are nothing, take() empties") {
  DirtyBoxes dirty;
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
