#include "core/drill/threshold_removal.h"

#include <algorithm>
#include <cmath>

#include "core/drill/projected_area.h"

namespace burrhole {
namespace {

constexpr float kSolid = 0.5f;  // density of the surface of bone

/// @returns the voxels whose centres may lie within `radius` [m] of `centre` [index], and the part of them that may be eroded.
VoxelBox box_round(const Vec3& centre, double radius, const Affine& index_from_bone) {
  Vec3 reach;
  // The largest index coordinate on a sphere is the radius times the length of that row of the map.
  for (int axis = 0; axis < 3; ++axis)
    reach[axis] =
        radius * glm::length(Vec3(index_from_bone.linear[0][axis], index_from_bone.linear[1][axis], index_from_bone.linear[2][axis]));
  return {Vec3i(glm::ceil(centre - reach)), Vec3i(glm::floor(centre + reach)) + 1};
}

/// Calls f(voxel, vector [m] from the centre) for each voxel of `allowed` whose centre lies within `radius` of `centre` [index].
template <class F>
void for_each_in_ball(const Voxmap& voxmap, const VoxelBox& allowed, const Vec3& centre, double radius, F&& f) {
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  const double within = radius * radius;
  for_each_voxel(box_round(centre, radius, bone_from_index.inverse()).intersect(allowed), [&](const Vec3i& v) {
    const Vec3 from = bone_from_index.linear * (Vec3(v) - centre);
    if (glm::dot(from, from) <= within) f(v, from);
  });
}

bool in_share(double x) { return x > 0.0 && x <= 1.0; }

}  // namespace

CuttingBall cutting_ball(const ErosionPoints& points) {
  CuttingBall out;
  double lowest = 0.0, widest = 0.0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!(points.factors[n] > 0.0f)) continue;
    const Vec3& p = points.positions[n];
    lowest = widest > 0.0 ? std::min(lowest, p.z) : p.z;
    widest = std::max(widest, std::hypot(p.x, p.y));
  }
  if (widest == 0.0) return out;
  out.radius = widest + 0.5 * points.pitch;  // a point is the centre of a cube
  out.centre = {0.0, 0.0, lowest - 0.5 * points.pitch + out.radius};
  return out;
}

Result<ThresholdRemoval> ThresholdRemoval::create(const ThresholdConfig& config, const ErosionPoints& points) {
  if (!(config.ultimate_strength > 0.0 && std::isfinite(config.ultimate_strength)))
    return Error{ErrorCode::out_of_range, "the ultimate strength must be a number above 0", {}};
  if (!in_share(config.reach) || !in_share(config.bearing_share))
    return Error{ErrorCode::out_of_range, "reach and bearing share of law \"threshold\" must be in (0, 1]", {}};
  return ThresholdRemoval(config, points);
}

double ThresholdRemoval::contact_area(const Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction) {
  const MasterWindow& window = voxmap.window();
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  solid_.clear();
  for_each_in_ball(voxmap, window.box, index_from_tool * ball_.centre, ball_.radius, [&](const Vec3i& v, const Vec3& from) {
    if (window.density[window.box.offset_of(v)] >= kSolid) solid_.push_back(from);
  });
  const Vec3 along = bone_from_index.linear * (index_from_tool.linear * reaction);
  return projected_area(solid_, glm::normalize(along), bone_from_index.mean_edge(), cells_);
}

void ThresholdRemoval::remove(Voxmap& voxmap, const Affine& index_from_tool, ErosionOutcome& outcome) {
  const MasterWindow& window = voxmap.window();
  const VoxelBox allowed = window.erodible_box();
  const Vec3 centre = index_from_tool * ball_.centre;
  const double radius = config_.reach * ball_.radius;
  const std::span<float> bone = voxmap.remaining();
  for_each_in_ball(voxmap, allowed, centre, radius, [&](const Vec3i& v, const Vec3&) {
    const std::size_t at = window.box.offset_of(v);
    if (bone[at] == 0.0f || window.occupancy[at] == 0.0f) return;
    outcome.removed_mass += static_cast<double>(window.occupancy[at]) * static_cast<double>(bone[at]);
    bone[at] = 0.0f;
    const Vec3i inside = v - window.box.lo;
    marks_.mark({inside.x & ~7, inside.y, inside.z}, 1u << (inside.x & 7));
    ++outcome.touched;
  });
  const VoxelBox wanted = box_round(centre, radius, voxmap.bone().bone_from_index().inverse());
  if (!allowed.contains(wanted))
    for_each_in_ball(voxmap, wanted, centre, radius, [&](const Vec3i& v, const Vec3&) { outcome.outside += allowed.contains(v) ? 0 : 1; });
}

ErosionOutcome ThresholdRemoval::step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load) {
  ErosionOutcome outcome;
  if (!(load.force > 0.0 && std::isfinite(load.force)) || !(ball_.radius > 0.0)) return outcome;
  const double area = config_.bearing_share * contact_area(voxmap, path.to, load.reaction);
  if (!(area > 0.0)) return outcome;
  outcome.stress = load.force / area;
  if (outcome.stress < config_.ultimate_strength) return outcome;
  outcome.substeps = static_cast<std::uint32_t>(substeps);
  marks_.reset(voxmap.window().box);
  for (int n = 1; n <= substeps; ++n) remove(voxmap, path.at(static_cast<double>(n) / substeps), outcome);
  outcome.removed_mass *= voxmap.bone().bone_from_index().cell_volume();
  outcome.changed = marks_.boxes();
  return outcome;
}

}  // namespace burrhole
