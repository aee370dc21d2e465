// What the display is sent of a voxel: the field that rays seek, and whose normal is stored where bone and soft tissue meet.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "app/view/texels.h"
#include "app/view/tissue_texels.h"
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

TEST_CASE("texels: made from what the bone's owner read, they are those made of the bone, in the window, outside and across its face") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys});
  Voxmap voxmap = make_patch(loaded);
  const VoxelBox all = voxmap.bone().bounds();
  const TexelBox before = make_texels(voxmap, all);
  const VoxelBox window{all.lo - 2, (all.lo + all.hi) / 2};
  REQUIRE(voxmap.place_window(window).ok());
  const VoxelBox cut{Vec3i(3), window.hi - 4};
  for_each_voxel(cut, [&](const Vec3i& v) { voxmap.remaining()[window.offset_of(v)] = (v.x + v.y + v.z) % 3 == 0 ? 0.0f : 0.6f; });
  voxmap.commit(cut);
  TexelSource source;  // its memory is used again
  for (const VoxelBox& box :
       {all, cut, VoxelBox{window.hi - 3, window.hi + 3}, VoxelBox{all.hi - 5, all.hi + 5}, VoxelBox{all.hi, all.hi + 2}}) {
    const TexelBox direct = make_texels(voxmap, box);
    read_texel_source(drawn_bone(voxmap), box, source);
    const TexelBox made = make_texels(voxmap.bone(), voxmap.config().gradient_dead_zone, source);
    CHECK(made.box == direct.box);
    CHECK(made.field == direct.field);
    CHECK((made.box.empty() ||
           std::memcmp(made.normal_opacity.data(), direct.normal_opacity.data(), made.normal_opacity.size() * sizeof(Rgba8)) == 0));
    CHECK(made.normal_opacity.size() == made.box.count());
  }
  const TexelBox after = make_texels(voxmap, all);
  CHECK(after.field != before.field);
  voxmap.write_back();
  CHECK(make_texels(voxmap, all).field == after.field);  // a read does not need it
}

TEST_CASE("texels: labelled tables and diploe of one density are drawn apart, and by density within their bounds") {
  const auto sponginess = [](VoxelLabel label, float hardness) {
    DenseBone dense;
    dense.dims = Vec3i(1);
    dense.bone_from_index = Affine::scaling(1e-3, Vec3(0.0));
    dense.occupancy = {1.0f};
    dense.hardness = {hardness};
    dense.labels = {static_cast<std::uint8_t>(label)};
    const auto bone = BoneModel::create(dense);
    REQUIRE(bone.ok());
    return static_cast<int>(make_tissue(**bone, (*bone)->bounds()).front().g);
  };
  for (const float hardness : {0.0f, 0.3f, 0.5f, 0.65f, 1.0f}) {
    CHECK(sponginess(VoxelLabel::diploe, hardness) >= 89);       // 0.35
    CHECK(sponginess(VoxelLabel::outer_table, hardness) <= 51);  // 0.2
    CHECK(sponginess(VoxelLabel::inner_table, hardness) <= 51);
  }
  CHECK(sponginess(VoxelLabel::bone, 0.5f) == sponginess(VoxelLabel::diploe, 0.5f));  // between the bounds
  CHECK(sponginess(VoxelLabel::bone, 0.3f) > sponginess(VoxelLabel::diploe, 0.7f));
}

}  // namespace burrhole::test
