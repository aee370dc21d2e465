// Bone read back from the textures, for slices.
#include <doctest/doctest.h>

#include "tests/app/render/render_scenes.h"

using namespace burrhole;
using namespace burrhole::test;

TEST_CASE("bone that is read back is what was sent, before and after an update, and nothing outside the volume") {
  const VolumeView volume = ball_on_plate();
  Renderer renderer = require_renderer();
  REQUIRE(renderer.read_mineral(Vec3(0.0), 1e-3)->empty());  // no volume yet
  REQUIRE(renderer.set_volume(volume).ok());
  const VoxelBox all{Vec3i(0), volume.dims};
  const Vec3 middle = volume.bone_from_index * (0.5 * Vec3(volume.dims));
  const double edge = volume.bone_from_index.mean_edge();
  const auto check = [&](const Vec3& centre, double half_width, const std::function<float(const Vec3i&)>& expected) {
    const auto levels = renderer.read_mineral(centre, half_width);
    REQUIRE(levels.ok());
    REQUIRE(levels->size() == 1);
    const MineralBox& read = levels->front();
    CHECK(all.contains(read.box));
    REQUIRE(read.values.size() == read.box.count());
    std::size_t n = 0;
    for (int z = read.box.lo.z; z < read.box.hi.z; ++z)
      for (int y = read.box.lo.y; y < read.box.hi.y; ++y)
        for (int x = read.box.lo.x; x < read.box.hi.x; ++x) REQUIRE(read.values[n++] == doctest::Approx(expected({x, y, z})).epsilon(1e-6));
    return n;
  };
  const auto sent = [&](const Vec3i& v) { return static_cast<float>(volume.normal_opacity[all.offset_of(v)].a) / 255.0f; };
  CHECK(check(middle, 3.0 * edge, sent) >= 6u * 6u * 6u);
  CHECK(check(middle, 1e3 * edge, sent) == all.count());
  CHECK(check(volume.bone_from_index * Vec3(volume.dims) + 50.0 * edge, 3.0 * edge, sent) == 0);
  // A box without bone.
  const Vec3i low = volume.dims / 2 - 2;
  TexelBox hole{{low, low + 4}, {}, {}};
  hole.normal_opacity.resize(hole.box.count());
  hole.field.resize(hole.box.count());
  renderer.update(hole);
  CHECK(check(middle, 4.0 * edge, [&](const Vec3i& v) { return hole.box.contains(VoxelBox{v, v + 1}) ? 0.0f : sent(v); }) > 64);
}
