/// app/render/frame_block.h: the uniform block of shaders/frame.glsl (std140) and how it is filled. Internal to app/render.
#pragma once

#include "app/engine/view.h"
#include "app/render/camera.h"

namespace burrhole {

using Vec4f = glm::fvec4;

/// Field for field the block Frame of shaders/frame.glsl, where each is documented. Only vec4 and mat4: no padding rule applies.
struct FrameBlock {
  Vec4f eye_index{0}, forward_index{0}, right_index{0}, up_index{0};
  Vec4f eye_world{0}, forward_world{0}, right_world{0}, up_world{0};
  Vec4f index_rows[3]{};
  Vec4f world_from_bone[3]{};
  Vec4f dims{1}, light{0}, light_terms{0}, cut{0}, lens{0}, edges{1};
  glm::fmat4 clip_from_tool{1}, world_from_tool{1}, clip_from_index{1}, world_from_index{1};
  Vec4f slices{0};
  Vec4f background_bottom{0}, background_top{0};
};
static_assert(sizeof(FrameBlock) == 39 * 16);

void fill_camera(FrameBlock& block, const CameraRays& rays);
/// @param dims [voxels] > 0.
void fill_volume(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index);
/// The axis whose slices are met most squarely, their number, and on which side of the eye they lie. @param per_voxel slices along it.
void fill_slices(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index, double per_voxel);
/// Light, background and cut of a view that was checked.
void fill_light_and_cut(FrameBlock& block, const FrameView& view);

}  // namespace burrhole
