/// app/render/frame_block.h: the uniform block of shaders/frame.glsl (std140), and functions that fill it. Internal to app/render.
///   Frame  as the names say: index, world, bone, tool, clip.   Units  SI and voxels, as documented in frame.glsl.   Errors  none.
#pragma once

#include <span>
#include <vector>

#include "app/view/camera.h"
#include "app/view/view.h"

namespace burrhole {

using Vec4f = glm::fvec4;

/// [texels] of the depths of the tool seen from the light: along the tool and across it.
inline constexpr Vec3i kToolDepthTexels{2048, 512, 1};

/// The block Frame of shaders/frame.glsl, which documents each field. Only vec4 and mat4 are used, so no padding rule applies.
struct FrameBlock {
  Vec4f eye_index{0}, forward_index{0}, right_index{0}, up_index{0};                          ///< [voxels]
  Vec4f eye_world{0}, forward_world{0}, right_world{0}, up_world{0};                          ///< [m], [-]
  Vec4f index_rows[3]{};                                                                      ///< [1/m]
  Vec4f world_from_bone[3]{};                                                                 ///< [-], [m]
  Vec4f dims{1}, light{0}, light_terms{0}, cut{0}, lens{0}, edges{1};                         ///< [unit of frame.glsl]
  glm::fmat4 clip_from_tool{1}, world_from_tool{1}, clip_from_index{1}, world_from_index{1};  ///< [unit of frame.glsl]
  Vec4f slices{0};                                                                            ///< [unit of frame.glsl]
  Vec4f background_bottom{0}, background_top{0};                                              ///< [-]
  Vec4f hole_lo{0}, hole_hi{0}, part{0}, whole_dims{0}, blend{0};                             ///< [voxels]
  Vec4f table{0}, table_x{0}, table_y{0}, table_cast{0}, table_color{0};                      ///< [unit of frame.glsl]
  Vec4f changed_lo{0}, changed_hi{0};                                                         ///< [voxels]
  glm::fmat4 clip_from_bone{1}, world_from_bone_at{1};                                        ///< [unit of frame.glsl]
  Vec4f skin{0}, fog{0}, focus{0};                                                            ///< [unit of frame.glsl]
  glm::fmat4 light_from_world{1};                                                             ///< [unit of frame.glsl]
};
static_assert(sizeof(FrameBlock) == 66 * 16);

void fill_camera(FrameBlock& block, const CameraRays& rays);
/// @param dims [voxels] > 0.
void fill_volume(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index);
/// For the whole volume: leaves out the box in which the detail is drawn.
void fill_hole(FrameBlock& block, const DetailGrid& grid);
/// For the detail. @param whole_dims [voxels] of the whole volume.
void fill_part(FrameBlock& block, const DetailGrid& grid, const Vec3i& whole_dims);
/// @param changed [voxels] of the volume of the block: round all texels that changed.
void fill_changed(FrameBlock& block, const VoxelBox& changed);
/// Chooses the axis whose slices face the view most directly, their number, and their order. @param per_voxel slices per voxel along the
/// axis.
void fill_slices(FrameBlock& block, const CameraRays& rays, const Vec3i& dims, const Affine& world_from_index, double per_voxel);
/// Appends the corners of the box of all voxel cells, to which rays are clipped, in world coordinates.
void append_corners(const Vec3i& dims, const Affine& world_from_index, std::vector<Vec3>& points);
/// Fills the place of what is drawn in the bone frame: a mesh, the skin. @param clip_from_world of the same picture.
void fill_bone_place(FrameBlock& block, const Pose& world_from_bone, const glm::dmat4& clip_from_world);
/// Fills the skin's colour, opacity and place. @param clip_from_world of the same picture.
void fill_skin(FrameBlock& block, const SkinView& skin, const Pose& world_from_bone, const glm::dmat4& clip_from_world);
/// Fills the projection along the light in which the tool's shadow is found. @param corners of the tool's box, and @param axis of the tool,
/// world. @pre the light is filled.
void fill_tool_shadow(FrameBlock& block, std::span<const Vec3> corners, const Vec3& axis);
/// @param rays of the same camera.
void fill_fog(FrameBlock& block, const CameraView& camera, const CameraRays& rays);
/// Fills light, background and cut. @pre the view was checked.
void fill_light_and_cut(FrameBlock& block, const FrameView& view);

}  // namespace burrhole
