#include <doctest/doctest.h>

#include "core/voxel/vdb_grids.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/write/drilled_ball.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const VoxelBox kAll{Vec3i(0), kBallDims};

}  // namespace

TEST_CASE("export: a .vdb read again is the same bone in every field, with the hole or without") {
  const TemporaryFolder folder;
  for (const Affine& map : {oblique_map(), sheared_map()}) {
    Voxmap bone = ball_voxmap(map, true);
    for (const bool undrilled : {false, true}) {
      REQUIRE(export_bone(bone, {.path = folder.file("a.vdb"), .undrilled = undrilled}).ok());
      const auto loaded = BoneModel::load(folder.file("a.vdb"));
      REQUIRE(loaded.ok());
      CHECK((*loaded)->bone_from_index().linear == map.linear);
      CHECK((*loaded)->bone_from_index().offset == map.offset);
      Voxmap again = Voxmap::create(*loaded, {}).value();
      const auto restored = again.restore(folder.file("a.vdb"));
      CHECK(restored.ok() != undrilled);  // no hole in a file of the bone as loaded
      if (!undrilled) CHECK(again.hash() == bone.hash());
      for (const ExportField field : {ExportField::density, ExportField::hardness, ExportField::labels})
        CHECK(field_of(again, field, undrilled, kAll) == field_of(bone, field, undrilled, kAll));
    }
  }
}

TEST_CASE("export: other programs find the density in a .vdb as a grid of that name, placed in mm") {
  const TemporaryFolder folder;
  const Voxmap bone = ball_voxmap(oblique_map(), true);
  for (const bool undrilled : {false, true}) {
    REQUIRE(export_bone(bone, {.path = folder.file("a.vdb"), .undrilled = undrilled}).ok());
    const auto foreign = read_foreign_grid(folder.file("a.vdb"), "density");
    REQUIRE(foreign.ok());
    CHECK_FALSE(foreign->level_set);
    std::vector<float> values(kAll.count());
    foreign->grid.read_box(kAll, values);
    CHECK(values == field_of(bone, ExportField::density, undrilled, kAll));
    // OpenVDB computes with the map in mm: rounding of numbers of 800.
    for (const Vec3& at : {Vec3(0.0), Vec3(kBallDims)})
      CHECK(glm::length(foreign->world_from_index * at - (oblique_map() * at) * 1e3) < 1e-9);
  }
}
