#include "app/view/whole_bone.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/view/coarse_bone.h"
#include "app/view/detail.h"
#include "app/view/texels.h"

namespace burrhole {
namespace {

constexpr float kDeadZone = 0.08f;  // [1/voxel] as VolumeScene
constexpr double kField = 0.6;      // [rad] vertical, as in a run
constexpr double kMargin = 0.90;    // [-] share of the picture that a box fills at most
constexpr double kSliceMargin = 1.28;

/// Nothing of this bone is removed but what was drilled before it was saved.
DrawnBone drawn_as_loaded(const BoneModel& bone) {
  return {&bone, [&bone](const VoxelBox& box, std::span<float> out) { bone.read_density(box, out); }, kDeadZone};
}

/// @returns density x hardness of the voxels that a plane needs.
MineralBox read_plane(const BoneModel& bone, const Vec3& middle, const Vec3& half) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  VoxelBox box;
  for (const Vec3& corner : Bounds{middle - half, middle + half}.corners()) {
    box.include(Vec3i(glm::floor(index_from_bone * corner)));
    box.include(Vec3i(glm::floor(index_from_bone * corner)) + 1);
  }
  MineralBox out{box.intersect(bone.bounds()), index_from_bone, {}};
  if (out.box.empty()) return out;
  out.values.resize(out.box.count());
  std::vector<float> hardness(out.box.count());
  bone.read_density(out.box, out.values);
  bone.read_hardness(out.box, hardness);
  std::ranges::transform(out.values, hardness, out.values.begin(), std::multiplies<>());
  return out;
}

/// Directions of a camera, at right angles, length 1.
struct Directions {
  Vec3 right, up, back;
};
Directions directions_of(const Vec3& back, const Vec3& above) {
  const Vec3 right = glm::normalize(glm::cross(above, back));
  return {right, glm::cross(back, right), back};
}

/// @returns the least distance from `middle` at which a camera sees all points, with the margin.
double distance_showing(std::span<const Vec3> shown, const Vec3& middle, const Directions& camera, double field, double aspect) {
  // A point is inside the picture if its distance from the axis is at most its depth times the tangent of half the field.
  const double half = std::tan(0.5 * field) * kMargin;
  double distance = 1e-3;
  for (const Vec3& point : shown) {
    const Vec3 p = point - middle;
    const double aside = std::max(std::abs(glm::dot(p, camera.right)) / (half * aspect), std::abs(glm::dot(p, camera.up)) / half);
    distance = std::max(distance, glm::dot(p, camera.back) + aside);
  }
  return distance;
}

/// The box as four lines in the picture of a slice.
std::vector<std::array<glm::dvec2, 2>> outline_of(const Bounds& box, const Vec3& middle, const TipSlices& slices, std::size_t plane) {
  const std::size_t u = plane == 2 ? 1 : 0, v = plane == 0 ? 1 : 2;  // axial: x, y; coronal: x, z; sagittal: y, z
  const double down = plane == 0 ? 1.0 : -1.0;
  const auto at = [&](double a, double b) { return glm::dvec2(a - middle[u], down * (b - middle[v])) / slices.pixel + 0.5 * slices.size; };
  const glm::dvec2 p = at(box.lo[u], box.lo[v]), q = at(box.hi[u], box.lo[v]), r = at(box.hi[u], box.hi[v]), s = at(box.lo[u], box.hi[v]);
  return {{p, q}, {q, r}, {r, s}, {s, p}};
}

}  // namespace

Result<VolumeView> make_whole_view(const BoneModel& bone, std::size_t most_voxels, bool tissue) {
  const int factor = coarse_factor(bone.dims(), most_voxels);
  if (factor == 1) return make_volume_view(drawn_as_loaded(bone), bone.bounds(), tissue);
  const auto coarse = CoarseBone::create(bone, factor);
  if (!coarse) return coarse.error();
  const BoneModel& loaded = coarse->loaded();
  return make_volume_view(drawn_as_loaded(loaded), loaded.bounds(), tissue);
}

LightView light_for(const CameraView& camera) {
  const Vec3 back = glm::normalize(camera.eye - camera.target);
  const Vec3 right = glm::normalize(glm::cross(camera.up, back));
  LightView out;
  out.direction_to_light = back + 0.6 * glm::cross(back, right) - 0.5 * right;
  return out;
}

Bounds bounds_of_bone(const BoneModel& bone) {
  const VoxelBox& box = bone.bone_box();
  return bounds_under(bone.bone_from_index(), Bounds{Vec3(box.lo), Vec3(box.hi - 1)});
}

std::vector<Vec3> outline_points(const BoneModel& bone) {
  std::vector<Vec3> out;
  bone.for_each_region([&](const VoxelBox& region) {
    const VoxelBox box = region.intersect(bone.bone_box());
    if (box.empty()) return;
    for (const Vec3& corner : Bounds{Vec3(box.lo), Vec3(box.hi - 1)}.corners()) out.push_back(bone.bone_from_index() * corner);
  });
  return out;
}

FrameView make_outer_frame(const Bounds& box, std::span<const Vec3> shown, const OuterView& view, double aspect) {
  const Vec3 middle = 0.5 * (box.lo + box.hi);
  const Vec3 back(std::sin(view.azimuth) * std::cos(view.elevation), -std::cos(view.azimuth) * std::cos(view.elevation),
                  std::sin(view.elevation));
  const double distance = distance_showing(shown, middle, directions_of(back, Vec3(0.0, 0.0, 1.0)), kField, aspect);
  FrameView out;
  out.camera.target = middle;
  out.camera.eye = middle + view.distance.value_or(distance) * back;
  out.camera.up = Vec3(0.0, 0.0, 1.0);
  out.camera.vertical_fov = kField;
  out.light = light_for(out.camera);
  if (view.cut) {
    const Vec3 across(std::abs(back.x), std::abs(back.y), std::abs(back.z));
    const std::size_t axis = across.x >= across.y && across.x >= across.z ? 0 : across.y >= across.z ? 1 : 2;
    Vec3 normal(0.0);
    normal[axis] = back[axis] < 0.0 ? -1.0 : 1.0;
    out.cut = FrameView::Cut{normal, glm::dot(normal, middle)};
  }
  return out;
}

void fit_camera(CameraView& camera, std::span<const Vec3> shown, double aspect) {
  const Directions seen = directions_of(glm::normalize(camera.eye - camera.target), camera.up);
  Bounds box = Bounds::none();
  for (const Vec3& p : shown) box.include({glm::dot(p, seen.right), glm::dot(p, seen.up), glm::dot(p, seen.back)});
  const Vec3 middle = 0.5 * (box.lo + box.hi);
  camera.target = middle.x * seen.right + middle.y * seen.up + middle.z * seen.back;
  camera.eye = camera.target + distance_showing(shown, camera.target, seen, camera.vertical_fov, aspect) * seen.back;
}

std::vector<BoxEdge> seen_edges(const Bounds& box, const Vec3& eye) {
  const auto is_seen = [&](std::size_t axis, bool high) { return high ? eye[axis] > box.hi[axis] : eye[axis] < box.lo[axis]; };
  std::vector<BoxEdge> out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 4; ++side) {
      const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
      const bool high_a = (side & 1u) != 0, high_b = (side & 2u) != 0;
      const bool seen_a = is_seen(a, high_a), seen_b = is_seen(b, high_b);
      if (!seen_a && !seen_b) continue;
      BoxEdge edge{box.lo, box.lo, axis, seen_a != seen_b};
      edge.from[a] = edge.to[a] = high_a ? box.hi[a] : box.lo[a];
      edge.from[b] = edge.to[b] = high_b ? box.hi[b] : box.lo[b];
      edge.to[axis] = box.hi[axis];
      out.push_back(edge);
    }
  return out;
}

TipSlices make_middle_slices(const BoneModel& bone, const Bounds& box, int size) {
  const Vec3 middle = 0.5 * (box.lo + box.hi), extent = box.hi - box.lo;
  const double half = 0.5 * kSliceMargin * std::max({extent.x, extent.y, extent.z, 1e-3});
  std::vector<MineralBox> planes;
  for (const std::size_t across : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
    Vec3 reach(half);
    reach[across] = 0.0;
    planes.push_back(read_plane(bone, middle, reach));
  }
  TipSlices out = make_tip_slices(planes, TriangleMesh{}, Pose{Quat(1, 0, 0, 0), middle}, half, size);
  for (std::size_t n = 0; n < out.planes.size(); ++n) out.planes[n].tool = outline_of(box, middle, out, n);
  return out;
}

}  // namespace burrhole
