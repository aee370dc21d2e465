// What steps do to the pictures of heat and of saline takes no memory.
#include <doctest/doctest.h>

#include "app/view/heat_mesh.h"
#include "app/view/saline_mesh.h"
#include "tests/support/memory_trap.h"

namespace burrhole::test {

TEST_CASE("heat picture: a step that changes bone takes no memory and no lock") {
  const VoxelBox cells{Vec3i(-20), Vec3i(20)};
  const BoneCells of_two(2);
  auto field = HeatField::create({}, Vec3(0.5e-3), cells);
  REQUIRE(field.ok());
  const VoxelBox voxels = of_two.voxels_of(cells);
  HeatPicture picture(*field, of_two, voxels, Affine::scaling(0.25e-3, Vec3(0.0)), 37.0, {});
  const std::vector<float> density(voxels.count(), 1.0f);
  clear_trap();
  on_trap([&] { picture.set_bone(voxels, density); });
  CHECK(trapped().allocations == 0);
  CHECK(trapped().locks == 0);
  // The sabotage: a copy for a picture, which may allocate, is noticed.
  field->set_bone(cells, std::vector<float>(cells.count(), 1.0f));
  field->release_at(Vec3i(0), 1.0);
  on_trap([&] { static_cast<void>(picture.copy_for_picture(false)); });
  CHECK(trapped().allocations > 0);
}

TEST_CASE(
    "saline picture: a step that changes bone and moves the film takes no memory and no lock, nor does a copy between steps of as much "
    "bone") {
  const VoxelBox voxels{Vec3i(-20), Vec3i(20)};
  SalinePicture picture(voxels, std::vector<Rgba8>(voxels.count()), Affine::scaling(0.25e-3, Vec3(0.0)));
  const std::vector<float> density(voxels.count(), 1.0f);
  const auto film_at = [](double x) { return SalineFilm{.tip = Vec3(x, 0.0, 0.0), .reach = 2e-3}; };
  clear_trap();
  on_trap([&] {
    picture.set_bone(voxels, density);
    picture.set_film(film_at(0.05e-3));
  });
  CHECK(trapped().allocations == 0);
  CHECK(trapped().locks == 0);
  // The sabotage: the first copy, which may allocate, is noticed.
  on_trap([&] { static_cast<void>(picture.copy_for_picture(true)); });
  CHECK(trapped().allocations > 0);
  picture.set_film(film_at(0.3e-3));  // by a voxel
  clear_trap();
  bool copied = false;
  on_trap([&] { copied = picture.copy_for_picture(true); });
  CHECK(copied);
  CHECK(trapped().allocations == 0);
  CHECK(trapped().locks == 0);
}

}  // namespace burrhole::test
