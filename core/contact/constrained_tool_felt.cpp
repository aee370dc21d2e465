// The constrained tool feels the hardness of bone: its coupling follows the relative stiffness under its contacts.
#include <algorithm>

#include "core/contact/constrained_tool.h"

namespace burrhole {
namespace {

constexpr int kDepths = 4;        // samples below a contact
constexpr double kAtRest = 2e-3;  // [m] below a contact that does not cut: the outermost voxels of a scan are mixed with soft tissue
constexpr double kLeast = 0.1;    // [-] as for bone_N_per_m

}  // namespace

// A contact that cuts feels the bone that it is about to cut, its engaged depth and a voxel, so that a layer is felt while the cutting face is in
// it. Only bone counts: neither its pores nor what lies behind it.
double ConstrainedTool::hardness_under_contacts(const SurfaceView& bone) const noexcept {
  if (bone.stiffness == nullptr) return -1.0;
  const Affine index_from_bone = bone.records.bone_from_index.inverse();
  const RecordSampler records(bone.records);
  double sum = 0.0, weights = 0.0;
  for (const HoldPlane& plane : solver_.planes()) {
    if (!(plane.force > 0.0) || plane.both_ways) continue;
    const Vec3 at = bone_from_tool_.translation + plane.arm + (plane.cutting ? engaged_ : Vec3(0.0));
    const double step = (plane.cutting ? state_.engagement + edge_ : kAtRest) / kDepths;
    double own = 0.0;
    int inside = 0;
    for (int n = 1; n <= kDepths; ++n) {
      const Vec3 index = index_from_bone * (at - n * step * plane.normal);
      const Vec3i v = voxel_of(index);
      const auto sample = records.at(index);
      if (!sample || sample->distance > 0.0 || !bone.records.box.contains(v)) continue;
      own += std::max(static_cast<double>(bone.stiffness[bone.records.box.offset_of(v)]) / 255.0, kLeast);
      ++inside;
    }
    if (inside == 0) continue;
    sum += plane.force * own / inside;
    weights += plane.force;
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
