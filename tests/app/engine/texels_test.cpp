// What the display is sent of a voxel: the field that rays seek, and whose normal is stored where bone and soft tissue meet.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/engine/texels.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

/// A voxel of the patch as the texture has it, and what it was made of.
struct Voxel {
  Rgba8 texel;
  std::uint16_t field = 0;
  float bone = 0.0f, soft = 0.0f;
  Vec3 bone_normal{0.0};  ///< of bone alone; zero where its density is flat
};

/// Those at least two voxels from the faces of the grid, where nothing but tissue decides.
std::vector<Voxel> inner_voxels(Voxmap& voxmap) {
  const VoxelBox all = voxmap.bone().bounds();
  const TexelBox texels = make_texels(voxmap, all);
  REQUIRE(texels.box == all);
  std::vector<float> bone(all.count()), soft(all.count());
  std::vector<Vec3f> gradient(all.count());
  voxmap.read_density(all, bone);
  voxmap.read_gradient(all, gradient);
  voxmap.bone().read_soft(all, soft);
  std::vector<Voxel> out;
  for_each_voxel(all.grown(-2), [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    const Vec3 down = -Vec3(gradient[n]);  // cubes along the axes of the bone
    const double length = glm::length(down);
    out.push_back({texels.normal_opacity[n], texels.field[n], bone[n], soft[n], length > 0.0 ? down / length : Vec3(0.0)});
  });
  return out;
}

Voxmap make_patch(const LoadedScene& loaded) {
  auto voxmap = Voxmap::create(loaded.bone, {});
  REQUIRE(voxmap.ok());
  return std::move(voxmap).value();
}

}  // namespace

TEST_CASE("texels: the field is the larger of bone and soft tissue, to 16 bits") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys});
  Voxmap voxmap = make_patch(loaded);
  int both = 0;
  for (const Voxel& v : inner_voxels(voxmap)) {
    const double larger = std::clamp(static_cast<double>(std::max(v.bone, v.soft)), 0.0, 1.0);
    REQUIRE(std::abs(v.field - 65535.0 * larger) <= 0.51);
    // The skip map asks alphas of 8 bits which voxels are solid: both must say the same of the level.
    const std::uint8_t soft = static_cast<std::uint8_t>(255.0f * v.soft + 0.5f);
    REQUIRE((std::max(v.texel.a, soft) >= 128) == (v.field >= 32768));
    both += v.bone > 0.1f && v.soft > 0.1f ? 1 : 0;
  }
  CHECK(both > 100);
}

TEST_CASE("texels: where dura lies under bone the normal is dura's, on bone alone it is bone's") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys});
  Voxmap voxmap = make_patch(loaded);
  int meeting = 0, bone_would_point_down = 0, alone = 0;
  for (const Voxel& v : inner_voxels(voxmap)) {
    const Vec3 stored = decode_normal(v.texel);
    if (v.soft > 0.25f && v.soft < 0.75f && v.bone > 0.2f) {
      ++meeting;
      REQUIRE(stored.z > 0.7);  // the patch is curved by a few degrees at most
      bone_would_point_down += v.bone_normal.z < -0.7 ? 1 : 0;
    }
    if (v.soft == 0.0f && v.bone > 0.25f && v.bone < 0.75f && v.bone_normal.z > 0.7) {
      ++alone;
      REQUIRE(glm::length(stored - v.bone_normal) < 0.02);  // rounding to 8 bits, a component 1/255
    }
  }
  CHECK(alone > 100);
  CHECK(meeting > 100);
  // Sabotage: bone's own normal there is the opposite one.
  CHECK(2 * bone_would_point_down > meeting);
}

}  // namespace burrhole::test
