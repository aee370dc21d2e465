// How far bone gives under a point that does not cut: by its hardness and by the factor of its label.
#include <doctest/doctest.h>

#include "surface_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr float kHardness = 0.6f;
constexpr double kBoneStiffness = 50e3;  // [N/m] soft, so that the give is most of the deflection
constexpr double kPressed = 1e-3;        // [m] of the hand beyond the face

/// A block under z = 0 in three layers; the labels of voxels outside it are those of what lies there.
DenseBone layered_block(VoxelLabel top) {
  DenseBone bone;
  bone.dims = Vec3i(24, 24, 32);
  bone.bone_from_index = Affine::scaling(kFineEdge, Vec3(-11.5, -11.5, -23.5) * kFineEdge);
  for_each_voxel({Vec3i(0), bone.dims}, [&](const Vec3i& v) {
    const double z = (bone.bone_from_index * Vec3(v)).z;
    bone.occupancy.push_back(static_cast<float>(std::clamp(0.5 - z / (2.0 * kFineEdge), 0.0, 1.0)));
    bone.hardness.push_back(kHardness);
    const VoxelLabel below = z < -1e-3 ? VoxelLabel::inner_table : top;
    bone.labels.push_back(static_cast<std::uint8_t>(z <= 0.0 ? below : VoxelLabel::brain));
  });
  return bone;
}

PointShell one_point() {
  PointShell shell;
  shell.positions = {Vec3(0.0)};
  shell.inward_normals = {Vec3(0.0, 0.0, 1.0)};
  shell.cutting = {0};
  return shell;
}

double force_on(VoxelLabel top, const LabelFactors& factors) {
  const ShippedBone bone(layered_block(top), {}, RecordPrecision::bits16, 19, factors);
  ConstrainedToolConfig config = locked();
  config.bone_stiffness = kBoneStiffness;
  auto tool = ConstrainedTool::create(config, one_point(), kFineEdge);
  REQUIRE(tool.ok());
  return settled_force(tool.value(), bone.view(), {glm::identity<Quat>(), Vec3(0.0, 0.0, 0.3e-3)}, Vec3(0.0, 0.0, -0.3e-3 - kPressed)).z;
}

LabelFactors only(VoxelLabel label, float factor) {
  LabelFactors out = kAllAlike;
  out[static_cast<std::size_t>(label)] = factor;
  return out;
}

/// Springs in series: the hand's coupling and the bone.
double closed_form(double factor) {
  return kPressed / (1.0 / kStiffness + 1.0 / (kBoneStiffness * static_cast<double>(kHardness) * factor));
}

// Stiffness is stored in steps of 1/255, so up to 0.5/255 of 0.06 at the least factor here: 3.3 %, of which the series passes on a half;
// for the factors of 1 it is 0.3 %. The felt face is within 0.01 voxel, 2.5 um of 1 mm.
constexpr double kAllowed = 0.02;

}  // namespace

TEST_CASE("surface: bone gives by its hardness times the factor of its label, in series with the coupling") {
  for (const VoxelLabel label :
       {VoxelLabel::bone, VoxelLabel::outer_table, VoxelLabel::diploe, VoxelLabel::inner_table, VoxelLabel::forbidden})
    for (const float factor : {1.0f, 0.5f, 0.25f}) {
      CAPTURE(static_cast<int>(label));
      CAPTURE(factor);
      const double force = force_on(label, only(label, factor)), expected = closed_form(static_cast<double>(factor));
      CHECK(std::abs(force / expected - 1.0) < kAllowed);
      // Sabotage: a give that knew hardness alone would be told apart by several times what is allowed.
      if (factor < 1.0f) CHECK(std::abs(closed_form(1.0) / expected - 1.0) > 5.0 * kAllowed);
    }
}

TEST_CASE("surface: the factor of a deeper layer is not felt at the face, and a factor never makes bone give without end") {
  const double plain = force_on(VoxelLabel::outer_table, kAllAlike);
  CHECK(force_on(VoxelLabel::outer_table, only(VoxelLabel::inner_table, 0.1f)) == plain);
  CHECK(force_on(VoxelLabel::outer_table, only(VoxelLabel::brain, 0.1f)) == plain);
  // At the least, a tenth of the stiffness of bone of hardness 1 holds.
  const double least = kPressed / (1.0 / kStiffness + 1.0 / (0.1 * kBoneStiffness));
  CHECK(std::abs(force_on(VoxelLabel::outer_table, only(VoxelLabel::outer_table, 0.01f)) / least - 1.0) < kAllowed);
}
