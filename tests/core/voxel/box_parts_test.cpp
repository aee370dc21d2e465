#include "core/voxel/box_parts.h"

#include <doctest/doctest.h>

#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

int mark_of(const Vec3i& v) { return v.x + 100 * v.y + 10'000 * v.z; }

}  // namespace

TEST_CASE("slide: values that both boxes hold move in place, whatever the sizes, within the capacity that was there") {
  Dice dice{1};
  for (int n = 0; n < 3000; ++n) {
    CAPTURE(n);
    const VoxelBox inside{Vec3i(0), Vec3i(14)};
    const VoxelBox from = dice.box_inside(inside, 9), to = dice.box_inside(inside, 9);
    std::vector<int> values(from.count()), apart(to.count(), -1);
    values.reserve(std::max(from.count(), to.count()));
    for_each_voxel(from, [&](const Vec3i& v) { values[from.offset_of(v)] = mark_of(v); });
    slide_values(from, values.data(), to, apart.data());
    const int* const memory = values.data();
    slide_array(from, to, values);
    REQUIRE(values.data() == memory);
    REQUIRE(values.size() == to.count());
    for_each_voxel(from.intersect(to), [&](const Vec3i& v) {
      REQUIRE(values[to.offset_of(v)] == mark_of(v));
      REQUIRE(apart[to.offset_of(v)] == mark_of(v));
    });
    for_each_voxel(to, [&](const Vec3i& v) { REQUIRE((from.contains(v) || apart[to.offset_of(v)] == -1)); });
  }
}
