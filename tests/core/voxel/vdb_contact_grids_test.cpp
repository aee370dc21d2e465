#include "core/voxel/vdb_contact_grids.h"

#include <doctest/doctest.h>

#include "tests/core/voxel/voxel_cases.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// @returns the number of voxels of the box where the grids differ from the twin, bit for bit.
int differing(const VdbContactGrids& grids, const PlainTwin& twin, const VoxelBox& box) {
  int count = 0;
  for_each_voxel(box,
                 [&](const Vec3i& v) { count += grids.density(v) == twin.density(v) && grids.gradient(v) == twin.gradient(v) ? 0 : 1; });
  return count;
}

}  // namespace

TEST_CASE("VdbContactGrids: equal the dense window voxel for voxel after erosion and slides, and lag until updated") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const DenseBone dense = random_bone({23, 20, 18}, seed);
    Voxmap voxmap = make_voxmap(load_bone(dense));
    PlainTwin twin(dense, 0.08f);
    const VoxelBox all = voxmap.bone().bounds().grown(2);
    VdbContactGrids grids(voxmap);
    REQUIRE(differing(grids, twin, all) == 0);
    int lagged = 0;
    for (int slide = 0; slide < 5; ++slide) {
      REQUIRE(voxmap.place_window(random_window(voxmap.bone().bounds(), dice)).ok());
      erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 7), dice);
      erode_box(voxmap, twin, dice.box_inside(voxmap.window().erodible_box(), 7), dice);
      lagged += differing(grids, twin, all);
      grids.update(voxmap);
      REQUIRE(differing(grids, twin, all) == 0);
      REQUIRE(difference(voxmap.window(), twin) == "");
    }
    CHECK(lagged > 0);
  }
}

TEST_CASE("VdbContactGrids: built over bone already drilled, and after a restore that grows bone back, equal the twin") {
  const TemporaryFolder folder;
  const DenseBone dense = random_bone({16, 17, 15}, 9);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  const PlainTwin whole(dense, 0.08f);
  PlainTwin twin = whole;
  const VoxelBox all = voxmap.bone().bounds().grown(2);
  REQUIRE(voxmap.save(folder.file("whole.vdb")).ok());
  REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
  Dice dice{9};
  erode_box(voxmap, twin, {Vec3i(2), Vec3i(12)}, dice);
  VdbContactGrids grids(voxmap);
  CHECK(differing(grids, twin, all) == 0);
  REQUIRE(voxmap.restore(folder.file("whole.vdb")).ok());
  grids.update(voxmap);
  CHECK(differing(grids, whole, all) == 0);
}
