#include "core/voxel/tile_marks.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

namespace {

/// Marks the voxels that `holds` names, eight of a row at a time.
VoxelBoxes boxes_of(TileMarks& marks, const VoxelBox& window, const std::function<bool(const Vec3i&)>& holds) {
  marks.reset(window);
  const Vec3i size = window.size();
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; i += 8) {
        std::uint32_t bits = 0;
        for (int n = 0; n < 8 && i + n < size.x; ++n) bits |= holds(window.lo + Vec3i(i + n, j, k)) ? 1u << n : 0u;
        marks.mark({i, j, k}, bits);
      }
  return marks.boxes();
}

/// @returns what is wrong with the set: voxels not covered, boxes that overlap or are empty, sides that hold no mark.
int faults(const VoxelBoxes& set, const VoxelBox& window, const std::function<bool(const Vec3i&)>& holds) {
  int wrong = set.size() > VoxelBoxes::kMax ? 1 : 0;
  VoxelBox all;
  for_each_voxel(window, [&](const Vec3i& v) {
    if (!holds(v)) return;
    all.include(v);
    wrong += set.contains(v) ? 0 : 1;
  });
  for (const VoxelBox& a : set)
    for (const VoxelBox& b : set) wrong += &a != &b && !a.intersect(b).empty() ? 1 : 0;
  for (const VoxelBox& box : set) wrong += box.empty() ? 1 : 0;
  return wrong + (set.bounds() == all ? 0 : 1);
}

}  // namespace

TEST_CASE("tile marks: disjoint boxes, at most sixteen, hold every mark and no more than the marks' own bounds") {
  TileMarks marks;  // one for all windows, as in use
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    const Vec3i lo(-7, 3, 100);
    const VoxelBox window{lo, lo + Vec3i(20 + static_cast<int>(seed), 41, 90 - static_cast<int>(seed))};
    const double density = std::pow(10.0, -4.5 * uniform01(seed, 1));
    const auto holds = [&](const Vec3i& v) { return uniform01(seed, window.offset_of(v) + 10) < density; };
    const VoxelBoxes set = boxes_of(marks, window, holds);
    CHECK(faults(set, window, holds) == 0);
    if (set.empty()) continue;
    // Sabotage: one voxel more, outside all boxes.
    const Vec3i extra = set.bounds().hi;
    CHECK(faults(set, window.unite({extra, extra + 1}), [&](const Vec3i& v) { return v == extra || (window.contains(v) && holds(v)); }) >
          0);
  }
}

TEST_CASE("tile marks: a ball is one box, a ring leaves its middle out, far corners stay apart, nothing is none") {
  const VoxelBox window{Vec3i(5), Vec3i(85)};
  TileMarks marks;
  const auto ball = [](const Vec3i& v) { return glm::length(Vec3(v) - 40.3) < 10.2; };
  const VoxelBoxes one = boxes_of(marks, window, ball);
  CHECK(faults(one, window, ball) == 0);
  CHECK(one.size() == 1);
  const auto ring = [](const Vec3i& v) {
    const double r = std::hypot(v.x - 44.2, v.y - 46.1);
    return r > 25.0 && r < 27.0 && v.z >= 40 && v.z < 46;
  };
  const VoxelBoxes round = boxes_of(marks, window, ring);
  CHECK(faults(round, window, ring) == 0);
  MESSAGE("a ring of radius 26: " << round.size() << " boxes, " << round.count() << " voxels of the union's " << round.bounds().count());
  CHECK(round.count() * 2 < round.bounds().count());
  CHECK_FALSE(round.contains(Vec3i(44, 46, 42)));
  const auto corners = [](const Vec3i& v) { return v == Vec3i(6) || v == Vec3i(84, 6, 6) || v == Vec3i(84); };
  CHECK(boxes_of(marks, window, corners).count() == 3);
  CHECK(boxes_of(marks, window, [](const Vec3i&) { return false; }).empty());
}

TEST_CASE("tile marks: a chequered window of the largest size is bounded work and still covered") {
  const VoxelBox window{Vec3i(0), Vec3i(256)};
  TileMarks marks;
  marks.reset(window);
  for (int k = 0; k < 256; k += 8)
    for (int j = 0; j < 256; j += 8)
      for (int i = 0; i < 256; i += 8)
        if ((i + j + k) % 16 == 0) marks.mark({i, j + 3, k + 5}, 1u);
  const VoxelBoxes set = marks.boxes();
  CHECK(set.size() <= VoxelBoxes::kMax);
  CHECK(set.contains(Vec3i(0, 3, 5)));
  CHECK(set.contains(Vec3i(248, 243, 245 + 8)) == true);
}
