// The constrained tool feels the hardness of bone: its coupling follows the relative stiffness under its contacts.
#include <algorithm>
#include <array>

#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

// [m] below a contact: bone yields over about the radius of the contact, and the outermost voxels of a scan are mixed with soft tissue
constexpr std::array<double, 4> kDepths{0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3};
constexpr double kLeast = 0.1;  // [-] as for bone_N_per_m

}  // namespace

double ConstrainedTool::hardness_under_contacts(const SurfaceView& bone) const noexcept {
  const Affine index_from_bone = bone.records.bone_from_index.inverse();
  double sum = 0.0, weights = 0.0;
  for (const HoldPlane& plane : solver_.planes()) {
    if (!(plane.force > 0.0) || plane.both_ways) continue;
    const Vec3 at = bone_from_tool_.translation + plane.arm + (plane.cutting ? engaged_ : Vec3(0.0));
    for (const double depth : kDepths) {
      const Vec3i v = voxel_of(index_from_bone * (at - depth * plane.normal));
      if (bone.stiffness == nullptr || !bone.records.box.contains(v)) continue;
      sum += plane.force * std::max(static_cast<double>(bone.stiffness[bone.records.box.offset_of(v)]) / 255.0, kLeast);
      weights += plane.force;
    }
  }
  return weights > 0.0 ? sum / weights : -1.0;
}

void ConstrainedTool::feel_hardness(const SurfaceView& bone, const Vec3& from, double dt) noexcept {
  const Vec3 force = bone.world_from_bone.inverse().rotate(state_.on_hand.force);  // outwards: the tool is pushed the other way
  const double length = glm::length(force);
  const Vec3 moved = bone_from_tool_.translation + engaged_ - from;
  felt_.update({.hardness = hardness_under_contacts(bone),
                .force = length,
                .stiffness = config_.coupling_stiffness,
                .advance = spinning_ && length > 0.0 ? -glm::dot(moved, force) / length : 0.0},
               dt);
  coupling_ = config_.coupling_stiffness * felt_.factor();
}

}  // namespace burrhole
