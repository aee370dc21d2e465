#include "app/render/frame_block.h"

#include <algorithm>
#include <cmath>

#include "app/render/footprint.h"
#include "core/base/bounds.h"

namespace burrhole {
namespace {

Vec4f vec4(const Vec3& v, double w = 0.0) { return Vec4f(glm::dvec4(v, w)); }

}  // namespace

void fill_camera(FrameBlock& block, const CameraRays& rays) {
  block.eye_world = vec4(rays.eye);
  block.forward_world = vec4(rays.forward);
  block.right_world = vec4(rays.right);
  block.up_world = vec4(rays.up);
}

void fill_volume(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index) {
  const Affine index_from_world = world_from_index.inverse();
  block.eye_index = vec4(index_from_world * rays.eye);
  block.forward_index = vec4(index_from_world.linear * rays.forward);
  block.right_index = vec4(index_from_world.linear * rays.right);
  block.up_index = vec4(index_from_world.linear * rays.up);
  const Mat3 rows = glm::transpose(index_from_world.linear);
  for (int axis = 0; axis < 3; ++axis) block.index_rows[axis] = vec4(rows[axis]);
  block.dims = vec4(Vec3(dims));
  const Mat3& cell = world_from_index.linear;
  block.edges = vec4({glm::length(cell[0]), glm::length(cell[1]), glm::length(cell[2])}, world_from_index.longest_edge());
}

void fill_hole(FrameBlock& block, const DetailGrid& grid) {
  // A coarse voxel inside the faces of the detail: a surface between the last sample before the hole and the hole is found by the detail.
  const double factor = grid.factor;
  block.light_terms.w = static_cast<float>(1.0 / factor);
  block.hole_lo = vec4(Vec3(grid.box.lo) / factor + 1.0, 1.0);
  block.hole_hi = vec4(Vec3(grid.box.hi - 1) / factor - 1.0, factor);
}

void fill_changed(FrameBlock& block, const VoxelBox& changed) {
  block.changed_lo = vec4(Vec3(changed.lo) - kLookUpVoxels);
  block.changed_hi = vec4(Vec3(changed.hi - 1) + kLookUpVoxels);
}

void fill_part(FrameBlock& block, const DetailGrid& grid, const Vec3i& whole_dims) {
  // Changes are given in voxels of the whole volume.
  const auto of_part = [&](const Vec4f& index) { return vec4(Vec3(index) * static_cast<double>(grid.factor) - Vec3(grid.box.lo)); };
  block.changed_lo = of_part(block.changed_lo);
  block.changed_hi = of_part(block.changed_hi);
  block.light_terms.w = 1.0f;
  block.part = vec4(Vec3(grid.box.lo), grid.factor);
  block.whole_dims = vec4(Vec3(whole_dims));
  block.blend = vec4({grid.ring(), grid.blend(), 0.0});
}

void fill_slices(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index, double per_voxel) {
  const Affine index_from_world = world_from_index.inverse();
  const Mat3 rows = glm::transpose(index_from_world.linear);
  glm::length_t axis = 0;
  double best = -1.0;
  for (glm::length_t a = 0; a < 3; ++a) {
    const double square_on = std::abs(glm::dot(glm::normalize(rows[a]), rays.axis));
    if (square_on > best) {
      best = square_on;
      axis = a;
    }
  }
  const double length = dims[axis];
  const double count = std::max(1.0, std::round(length * per_voxel));
  const double eye = ((index_from_world * rays.eye)[axis] + 0.5) / length * count;  // in slices
  const double beyond = count - std::clamp(std::ceil(eye - 0.5), 0.0, count);
  block.slices = vec4(Vec3(static_cast<double>(axis), count, beyond), world_from_index.mean_edge());
}

void fill_light_and_cut(FrameBlock& block, const FrameView& view) {
  block.light = vec4(glm::normalize(view.light.direction_to_light));
  block.light_terms = vec4({view.light.ambient, view.light.diffuse, view.light.fill}, 1.0);
  block.background_bottom = vec4(view.background.bottom);
  block.background_top = vec4(view.background.top);
  if (view.table) {
    const TableView& table = *view.table;
    block.table = vec4(table.normal, table.offset);
    const Vec3 x = table.half_x / glm::dot(table.half_x, table.half_x), y = table.half_y / glm::dot(table.half_y, table.half_y);
    block.table_x = vec4(x, glm::dot(x, table.centre));
    block.table_y = vec4(y, glm::dot(y, table.centre));
    // The middle of what lies on the table casts its shadow there; the light is at least 20 degrees above the table.
    const Vec3 light = glm::normalize(view.light.direction_to_light);
    const Vec3 shift = -light * (table.height / std::max(glm::dot(light, table.normal), 0.34));
    block.table_cast = vec4({glm::dot(x, shift), glm::dot(y, shift), 0.0});
    block.table_color = vec4(table.color);
  }
  if (!view.cut) return;
  const double length = glm::length(view.cut->normal);
  block.cut = vec4(view.cut->normal / length, view.cut->offset / length);
}

void fill_bone_place(FrameBlock& block, const Pose& world_from_bone, const glm::dmat4& clip_from_world) {
  glm::dmat4 matrix(glm::mat3_cast(world_from_bone.rotation));
  matrix[3] = glm::dvec4(world_from_bone.translation, 1.0);
  block.world_from_bone_at = glm::fmat4(matrix);
  block.clip_from_bone = glm::fmat4(clip_from_world * matrix);
}

void fill_skin(FrameBlock& block, const SkinView& skin, const Pose& world_from_bone, const glm::dmat4& clip_from_world) {
  fill_bone_place(block, world_from_bone, clip_from_world);
  block.skin = vec4(skin.color, skin.opacity);
}

void fill_tool_shadow(FrameBlock& block, std::span<const Vec3> corners, const Vec3& axis) {
  const Vec3 light(block.light);
  const Vec3 beside = std::abs(light.x) < 0.8 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 across_axis = glm::cross(light, axis);
  // Rows of the projection: across the light, the first along the tool; then away from the light.
  const Vec3 y = glm::normalize(glm::length(across_axis) > 1e-3 ? across_axis : glm::cross(light, beside));
  const Vec3 rows[3] = {glm::cross(y, light), y, -light};
  glm::dmat4 matrix(1.0);
  for (glm::length_t row = 0; row < 3; ++row) {
    double least = INFINITY, most = -INFINITY;
    for (const Vec3& corner : corners) {
      least = std::min(least, glm::dot(rows[row], corner));
      most = std::max(most, glm::dot(rows[row], corner));
    }
    // Two texels at each edge, and a share of the depths at each end, stay empty.
    const double kept = row < 2 ? 1.0 - 4.0 / kToolDepthTexels[row] : 0.99;
    const double scale = 2.0 * kept / std::max(most - least, 1e-9);
    for (glm::length_t column = 0; column < 3; ++column) matrix[column][row] = scale * rows[row][column];
    matrix[3][row] = -0.5 * scale * (least + most);
  }
  block.light_from_world = glm::fmat4(matrix);
}

void fill_fog(FrameBlock& block, const CameraView& camera, const CameraRays& rays) {
  if (!camera.fog) return;
  block.fog = vec4(camera.fog->color);
  block.focus = vec4({glm::dot(camera.target - rays.eye, rays.axis), 1.0 / camera.fog->depth, 0.0});
}

void append_corners(const Vec3i& dims, const Affine& world_from_index, std::vector<Vec3>& points) {
  for (const Vec3& corner : Bounds{Vec3(-0.5), Vec3(dims) - 0.5}.corners()) points.push_back(world_from_index * corner);
}

}  // namespace burrhole
