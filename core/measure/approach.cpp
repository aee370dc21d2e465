#include "core/measure/approach.h"

#include <array>
#include <cmath>

#include "core/base/trilinear.h"
#include "core/contact/contact_view.h"
#include "core/measure/approach_check.h"

namespace burrhole {
namespace {

constexpr double kInside = 3e-3;  // [m] dura or brain within this distance above the entry means that the axis comes from inside
constexpr double kSearch = 0.020, kDeepest = 0.060, kGap = 0.002;  // [m]

/// Bisects the 0.5 level between two depths on a line; one end is outside bone, the other inside.
double refine(const BoneModel& bone, const Affine& index_from_bone, const Vec3& origin, const Vec3& axis, double a, double b,
              bool a_inside) {
  for (int n = 0; n < 20; ++n) {
    const double middle = 0.5 * (a + b);
    const bool inside = sample_occupancy(bone, index_from_bone * (origin + axis * middle)) >= kSurfaceLevel;
    (inside == a_inside ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

Vec3 outward_normal(const BoneModel& bone, const Affine& index_from_bone, const Vec3& at) {
  // Central differences over one and a half voxels: less sensitive to noise than the voxel gradient. Along the axes of the grid: there the
  // ramp of a surface that is square to one of them ends within the step, which would bend the normal along other axes.
  const double h = 1.5 * bone.bone_from_index().mean_edge();
  Mat3 axes;
  Vec3 slopes(0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    axes[c] = glm::normalize(bone.bone_from_index().linear[c]);
    slopes[c] = sample_occupancy(bone, index_from_bone * (at + h * axes[c])) - sample_occupancy(bone, index_from_bone * (at - h * axes[c]));
  }
  const Vec3 gradient = glm::transpose(glm::inverse(axes)) * slopes;
  const double length = glm::length(gradient);
  return length > 0.0 ? -gradient / length : Vec3(0.0);
}

void list_layers(const BoneModel& bone, Approach& out) {
  for (std::size_t n = 0; n < out.axis_index.size(); ++n) {
    const VoxelLabel label = bone.label(voxel_of(out.axis_index[n]));
    if (out.layers.empty() || out.layers.back().label != label) out.layers.push_back({label, out.axis_depth[n], out.axis_depth[n]});
    out.layers.back().to = out.axis_depth[n];
  }
}

Error refused(const std::string& why, const std::optional<ApproachStart>& start) {
  return bad_input(start ? why + "; bone begins at " + start_text(*start) : why);
}

}  // namespace

double sample_occupancy(const BoneModel& bone, const Vec3& index) {
  const Vec3i base = floor_int(index);
  std::array<float, 8> corner{};
  bone.read_occupancy({base, base + 2}, corner);
  return trilinear(index - Vec3(base), [&](unsigned n) { return static_cast<double>(corner[n]); });
}

Result<Approach> make_approach(const BoneModel& bone, const ApproachScene& scene) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const double step = 0.25 * bone.bone_from_index().mean_edge();
  const auto inside = [&](const Vec3& origin, double depth) {
    return sample_occupancy(bone, index_from_bone * (origin + scene.axis * depth)) >= kSurfaceLevel;
  };

  double start = -kSearch;
  if (inside(scene.entry, start))
    return refused("the approach starts inside bone: no free space within 20 mm above entry_mm", start_above(bone, scene));
  while (start < kSearch && !inside(scene.entry, start + step)) start += step;
  if (start >= kSearch) return refused("the approach axis meets no bone within 20 mm of entry_mm", start_where_bone_is(bone, scene));
  start = refine(bone, index_from_bone, scene.entry, scene.axis, start, start + step, false);

  Approach out;
  const Vec3 entry = scene.entry + scene.axis * start;
  out.bone_from_approach = {rotation_from_z(-scene.axis), entry};
  double last_inside = 0.0;
  for (double depth = 0.5 * step; depth < kDeepest && depth - last_inside < kGap; depth += step) {
    if (!inside(entry, depth)) continue;
    last_inside = depth;
    out.axis_index.push_back(index_from_bone * (entry + scene.axis * depth));
    out.axis_depth.push_back(depth);
  }
  if (last_inside + kGap >= kDeepest) return bad_input("bone does not end within 60 mm along the approach axis");
  out.thickness = refine(bone, index_from_bone, entry, scene.axis, last_inside, last_inside + step, true);
  out.normal = outward_normal(bone, index_from_bone, entry);
  out.angle = std::acos(std::clamp(glm::dot(-scene.axis, out.normal), -1.0, 1.0));
  list_layers(bone, out);
  for (double above = step; above < kInside && !out.from_inside; above += step) {
    const VoxelLabel label = bone.label(voxel_of(index_from_bone * (entry - scene.axis * above)));
    out.from_inside = label == VoxelLabel::dura || label == VoxelLabel::brain;
  }
  return out;
}

}  // namespace burrhole
