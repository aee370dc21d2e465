#include "app/render/skip_map.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/random.h"

using namespace burrhole;

namespace {

const Vec3i kDims(41, 13, 17);
const VoxelBox kAll{Vec3i(0), kDims};

/// The slow twin: the least over all solid voxels.
int true_distance(const std::vector<std::uint8_t>& solid, const Vec3i& v) {
  int least = kMaxSkip;
  for_each_voxel(kAll, [&](const Vec3i& q) {
    if (solid[kAll.offset_of(q)] == 0) return;
    const Vec3i d = glm::abs(q - v);
    least = std::min(least, std::max({d.x, d.y, d.z}));
  });
  return least;
}

std::vector<std::uint8_t> few_solid(std::uint64_t seed, int one_in) {
  std::vector<std::uint8_t> solid(kAll.count());
  for (std::size_t n = 0; n < solid.size(); ++n) solid[n] = mix64(seed + n) % static_cast<std::uint64_t>(one_in) == 0;
  return solid;
}

}  // namespace

TEST_CASE("skip map: it is the Chebyshev distance to the nearest solid voxel, capped") {
  for (const int one_in : {50, 2000, 5000}) {
    const std::vector<std::uint8_t> solid = few_solid(7, one_in);
    const SkipMap map(kDims, solid);
    for_each_voxel(kAll, [&](const Vec3i& v) { REQUIRE(int{map.distances()[kAll.offset_of(v)]} == true_distance(solid, v)); });
  }
}

TEST_CASE("skip map: an empty volume is far from everything") {
  const SkipMap map(kDims, std::vector<std::uint8_t>(kAll.count(), 0));
  CHECK(std::all_of(map.distances().begin(), map.distances().end(), [](std::uint8_t d) { return d == kMaxSkip; }));
}

TEST_CASE("skip map: after growth it is never more than the true distance, nor more than before") {
  std::vector<std::uint8_t> solid = few_solid(11, 3000);
  SkipMap map(kDims, solid);
  const std::vector<std::uint8_t> before(map.distances().begin(), map.distances().end());
  const VoxelBox box{{30, 2, 3}, {36, 8, 9}};
  std::vector<std::uint8_t> grown(box.count(), 0);
  grown[box.offset_of({31, 3, 4})] = 1;
  grown[box.offset_of({34, 6, 7})] = 1;
  const VoxelBox changed = map.raise(box, grown);
  for_each_voxel(box, [&](const Vec3i& v) { solid[kAll.offset_of(v)] |= grown[box.offset_of(v)]; });
  for_each_voxel(kAll, [&](const Vec3i& v) {
    const std::size_t n = kAll.offset_of(v);
    REQUIRE(int{map.distances()[n]} <= true_distance(solid, v));
    REQUIRE(map.distances()[n] <= before[n]);
    if (!changed.contains(v)) REQUIRE(map.distances()[n] == before[n]);
  });
}

TEST_CASE("skip map: what it knows already changes nothing") {
  SkipMap map(kDims, std::vector<std::uint8_t>(kAll.count(), 1));
  const VoxelBox box{{3, 3, 3}, {6, 6, 6}};
  CHECK(map.raise(box, std::vector<std::uint8_t>(box.count(), 1)).empty());
  CHECK(map.raise(box, std::vector<std::uint8_t>(box.count(), 0)).empty());
}
