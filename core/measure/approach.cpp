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

/// Why an axis does not begin outside bone and meet it.
enum class Miss { none, begins_in_bone, no_bone };

/// make_approach() without a place to start in its errors.
Result<Approach> measure_approach(const BoneModel& bone, const ApproachScene& scene, Miss& miss) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const double step = 0.25 * bone.bone_from_index().mean_edge();
  const auto inside = [&](const Vec3& origin, double depth) {
    return sample_occupancy(bone, index_from_bone * (origin + scene.axis * depth)) >= kSurfaceLevel;
  };

  double start = -kSearch;
  miss = inside(scene.entry, start) ? Miss::begins_in_bone : Miss::none;
  if (miss != Miss::none) return bad_input("the approach starts inside bone: the point 20 mm above entry_mm is bone");
  while (start < kSearch && !inside(scene.entry, start + step)) start += step;
  miss = start >= kSearch ? Miss::no_bone : Miss::none;
  if (miss != Miss::none) return bad_input("the approach axis meets no bone within 20 mm of entry_mm");
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

/// @returns the valid approach that begins at `start`, or, if its axis leaves the skull, the opposite one; nothing if neither is valid.
std::optional<ApproachStart> valid_start(const BoneModel& bone, const ApproachStart& start) {
  Miss miss = Miss::none;
  auto found = measure_approach(bone, {start.entry, start.axis, {}}, miss);
  Vec3 axis = start.axis;
  if (found && leaves_skull(bone, *found)) {
    axis = -axis;
    found = measure_approach(bone, {found->bone_from_approach.translation - axis * found->thickness, axis, {}}, miss);
  }
  if (!found || leaves_skull(bone, *found)) return std::nullopt;
  return ApproachStart{found->bone_from_approach.translation, axis};
}

/// @returns the start in LPS of an approach that was written in RAS, if bone is there.
std::optional<ApproachStart> start_in_ras(const BoneModel& bone, const ApproachScene& scene) {
  const Vec3 lps_from_ras(-1.0, -1.0, 1.0);
  ApproachScene mirrored = scene;
  mirrored.entry = lps_from_ras * scene.entry;
  mirrored.axis = lps_from_ras * scene.axis;
  Miss miss = Miss::none;
  const auto found = measure_approach(bone, mirrored, miss);
  if (!found || leaves_skull(bone, *found)) return std::nullopt;
  return ApproachStart{mirrored.entry, mirrored.axis};
}

}  // namespace

double sample_occupancy(const BoneModel& bone, const Vec3& index) {
  const Vec3i base = floor_int(index);
  std::array<float, 8> corner{};
  bone.read_occupancy({base, base + 2}, corner);
  return trilinear(index - Vec3(base), [&](unsigned n) { return static_cast<double>(corner[n]); });
}

Result<Approach> make_approach(const BoneModel& bone, const ApproachScene& scene) {
  Miss miss = Miss::none;
  const auto out = measure_approach(bone, scene, miss);
  if (out || miss == Miss::none) return out;
  std::string message = out.error().message;
  if (const std::string way = way_to_bone(bone, scene.entry); miss == Miss::no_bone && !way.empty()) message += ": " + way;
  if (const auto mirrored = miss == Miss::no_bone ? start_in_ras(bone, scene) : std::nullopt)
    return bad_input(message + "; if the entry was written in RAS, as 3D Slicer shows points, the same place in LPS is " +
                     start_text(*mirrored));
  for (const ApproachStart& possible : possible_starts(bone, scene))
    if (const auto start = valid_start(bone, possible)) return bad_input(message + "; bone begins at " + start_text(*start));
  return bad_input(message);
}

}  // namespace burrhole
