// Dura and brain that are assumed under the bone of a scan: a shell has a closed form.
#include "app/view/assumed_brain.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/bounds.h"
#include "core/base/trilinear.h"

using namespace burrhole;

namespace {

constexpr double kEdge = 0.5e-3, kRadius = 60e-3, kThickness = 6e-3;  // [m]

/// A cap of a spherical shell about (0, 0, -kRadius), so that the entry is at the origin. @param soft below it.
/// @param label of the bone.
std::shared_ptr<const BoneModel> cap(bool soft = false, VoxelLabel label = VoxelLabel::bone) {
  DenseBone dense;
  dense.dims = Vec3i(90, 90, 60);
  dense.bone_from_index = Affine::scaling(kEdge, kEdge * Vec3(-44.5, -44.5, -54.5));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const double r = glm::length(dense.bone_from_index * Vec3(v) + Vec3(0.0, 0.0, kRadius));
    const auto occupancy = static_cast<float>(std::clamp(0.5 - std::max(r - kRadius, kRadius - kThickness - r) / (2.0 * kEdge), 0.0, 1.0));
    dense.occupancy.push_back(occupancy);
    dense.hardness.push_back(occupancy > 0.0f ? 0.8f : 0.0f);
    dense.labels.push_back(occupancy >= 0.5f ? static_cast<std::uint8_t>(label) : 0);
    if (soft) dense.soft.push_back(r < kRadius - kThickness ? 1.0f : 0.0f);
  });
  auto bone = BoneModel::create(dense);
  REQUIRE(bone.ok());
  return *bone;
}

constexpr std::uint8_t kBoneGreen = 190, kDuraGreen = 158;

/// Bone as it is drawn, of one colour.
VolumeView drawn(const BoneModel& bone) {
  VolumeView volume;
  volume.dims = bone.dims();
  volume.bone_from_index = bone.bone_from_index();
  std::vector<float> occupancy(bone.bounds().count());
  bone.read_occupancy(bone.bounds(), occupancy);
  for (const float o : occupancy) {
    volume.normal_opacity.push_back({128, 128, 128, static_cast<std::uint8_t>(255.0f * o)});
    volume.color.push_back({200, kBoneGreen, 170, 0});
    volume.field.push_back(static_cast<std::uint16_t>(65535.0f * o));
    volume.tissue.push_back({static_cast<std::uint8_t>(255.0f * o), 7});
  }
  return volume;
}

}  // namespace

TEST_CASE("assumed brain: its surface lies on the inner surface of a shell, and its normal is that of the shell") {
  const auto brain = AssumedBrain::create(*cap(), Pose{}, kThickness, kEdge);
  REQUIRE(brain.has_value());
  const double inner = kRadius - kThickness;
  for (const double x : {-0.012, 0.0, 0.005, 0.014})
    for (const double y : {-0.010, 0.0, 0.013}) {
      const double depth = kRadius - std::sqrt(inner * inner - x * x - y * y);
      const auto found = brain->inner_depth(x, y);
      REQUIRE(found.has_value());
      CHECK(std::abs(*found - depth) < 0.5 * kEdge);  // a column is sampled at half a voxel
      const Vec3 below(x, y, -depth - 4e-3), above(x, y, -depth + 3e-3);
      CHECK(brain->at(below, kEdge).soft == 1.0);
      CHECK(brain->at(above, kEdge).soft == 0.0);
      CHECK_FALSE(brain->at(below, kEdge).dura);
      const auto surface = brain->at(Vec3(x, y, -*found), kEdge);
      CHECK(surface.dura);
      const Vec3 radial = glm::normalize(Vec3(x, y, kRadius - depth));
      if (surface.normal != Vec3(0.0)) CHECK(glm::dot(surface.normal, radial) > std::cos(0.1));
    }
}

TEST_CASE("assumed brain: the colour under exposed dura is that of dura everywhere, without stripes of bone") {
  const auto bone = cap();
  const auto brain = AssumedBrain::create(*bone, Pose{}, kThickness, kEdge);
  REQUIRE(brain.has_value());
  VolumeView volume = drawn(*bone);
  brain->add_to(volume);
  const VoxelBox all{Vec3i(0), volume.dims};
  const Affine index_from_bone = volume.bone_from_index.inverse();
  const auto filtered = [&](const Vec3& p_bone, const auto& value) {
    const Vec3 index = index_from_bone * p_bone;
    const Vec3i low(glm::floor(index));
    return trilinear(index - Vec3(low), [&](unsigned n) { return static_cast<double>(value(all.offset_of(low + cell_corner(n)))); });
  };
  std::vector<int> dura;
  for_each_voxel(all, [&](const Vec3i& v) { dura.push_back(brain->at(volume.bone_from_index * Vec3(v), kEdge).dura ? 255 : 0); });
  double most_bone = 0.0, most_spongy = 0.0;
  int count = 0;
  for (double x = -14e-3; x <= 14e-3; x += 0.13e-3)
    for (double y = -14e-3; y <= 14e-3; y += 0.51e-3) {
      // The surface of dura, by bisection along the column; from there the place that determines its colour in the shader.
      const auto inner = brain->inner_depth(x, y);
      REQUIRE(inner.has_value());
      double free = *inner - 2e-3, inside = *inner + 0.5e-3;
      for (int n = 0; n < 30; ++n) {
        const double middle = 0.5 * (free + inside);
        (brain->at(Vec3(x, y, -middle), kEdge).soft >= 0.5 ? inside : free) = middle;
      }
      const Vec3 surface(x, y, -inside);
      const Vec3 normal = glm::normalize(surface + Vec3(0.0, 0.0, kRadius));
      const Vec3 sampled = surface - 0.75 * kEdge * normal;
      const double green = filtered(sampled, [&](std::size_t n) { return volume.color[n].g; });
      most_bone = std::max(most_bone, (green - kDuraGreen) / (kBoneGreen - kDuraGreen));
      // Dura, or brain where the filter reaches it; a sponginess of bone is neither.
      const double kind = filtered(sampled, [&](std::size_t n) { return volume.tissue[n].g; });
      const double expected = filtered(sampled, [&](std::size_t n) { return dura[n]; });
      most_spongy = std::max(most_spongy, std::abs(kind - expected));
      ++count;
    }
  CHECK(count > 10000);
  CHECK(most_bone < 0.03);  // by corners of the filter more than half a voxel above dura
  CHECK(most_spongy < 8.0);
}

TEST_CASE("assumed brain: none for bone that has soft tissue or layers, or is thicker than a skull") {
  CHECK_FALSE(AssumedBrain::create(*cap(true), Pose{}, kThickness, kEdge).has_value());
  CHECK_FALSE(AssumedBrain::create(*cap(false, VoxelLabel::diploe), Pose{}, kThickness, kEdge).has_value());
  CHECK_FALSE(AssumedBrain::create(*cap(), Pose{}, 0.05, kEdge).has_value());
}

TEST_CASE("assumed brain: changed texels get the same field as the volume, and bone keeps its own") {
  const auto bone = cap();
  const auto brain = AssumedBrain::create(*bone, Pose{}, kThickness, kEdge);
  REQUIRE(brain.has_value());
  VolumeView volume = drawn(*bone);
  const VoxelBox all{Vec3i(0), volume.dims}, part{{30, 20, 25}, {60, 50, 50}};
  TexelBox texels{part, {}, {}};
  for_each_voxel(part, [&](const Vec3i& v) {
    texels.normal_opacity.push_back(volume.normal_opacity[all.offset_of(v)]);
    texels.field.push_back(volume.field[all.offset_of(v)]);
  });
  const VolumeView before = volume;
  brain->add_to(volume);
  brain->add_to(texels, volume.bone_from_index);
  std::size_t n = 0, filled = 0;
  bool equal = true, bone_kept = true;
  for_each_voxel(part, [&](const Vec3i& v) {
    const std::size_t at = all.offset_of(v);
    equal = equal && texels.field[n] == volume.field[at] && texels.normal_opacity[n] == volume.normal_opacity[at];
    bone_kept = bone_kept && volume.field[at] >= before.field[at] && volume.normal_opacity[at].a == before.normal_opacity[at].a;
    // Half a voxel above dura and higher, bone has the colour and the sponginess of bone.
    const double soft = brain->at(volume.bone_from_index * Vec3(v), kEdge).soft;
    if (before.normal_opacity[at].a > 127 && soft < 0.25)
      bone_kept = bone_kept && volume.tissue[at].g == 7 && volume.color[at].g == kBoneGreen;
    filled += volume.field[at] > before.field[at] ? 1 : 0;
    ++n;
  });
  CHECK(equal);
  CHECK(bone_kept);
  CHECK(filled > part.count() / 4);
}
