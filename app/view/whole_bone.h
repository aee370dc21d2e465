/// app/view/whole_bone.h: pictures of a bone without a scene: all of it from outside, and three slices through its middle. No OpenGL.
///   Frame  bone frame, which is also the world's (LPS).   Units  SI.   Errors  bad_input.   Thread  any; reads the bone as loaded.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "app/view/tip_slices.h"
#include "app/view/view.h"
#include "core/base/bounds.h"
#include "core/base/result.h"
#include "core/base/units.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

/// @returns the bone as loaded for a display, at coarser voxels if it has more than `most_voxels`. @param tissue also the state of each voxel.
[[nodiscard]] Result<VolumeView> make_whole_view(const BoneModel& bone, std::size_t most_voxels, bool tissue);

/// @returns the light of a run: from the upper left, behind the person's shoulder.
[[nodiscard]] LightView light_for(const CameraView& camera);

/// @returns the box around the voxels that have bone. @pre the bone is not empty.
[[nodiscard]] Bounds bounds_of_bone(const BoneModel& bone);

/// A view of a box from outside.
struct OuterView {
  double azimuth = 35.0 * kDegree;    ///< [rad] about +z, from -y towards +x: from anterior towards the left
  double elevation = 18.0 * kDegree;  ///< [rad] above the xy plane
  std::optional<double> distance{};   ///< [m] from the middle of the box; absent: the least that shows all of it
  bool cut = false;                   ///< a section through the middle, across the axis that faces the camera most, without the nearer side
};
/// @param shown points that the picture holds. @param aspect width / height of the picture.
[[nodiscard]] FrameView make_outer_frame(const Bounds& box, std::span<const Vec3> shown, const OuterView& view, double aspect);
/// Moves a camera, without a turn, so that the points fill nine tenths of the picture. @param aspect width / height. @pre there are points.
void fit_camera(CameraView& camera, std::span<const Vec3> shown, double aspect);
/// @returns points of boxes that hold all of the bone.
[[nodiscard]] std::vector<Vec3> outline_points(const BoneModel& bone);

/// An edge of a box.
struct BoxEdge {
  Vec3 from{0.0}, to{0.0};  ///< [m]
  std::size_t axis = 0;     ///< along which it runs
  bool outline = false;     ///< only one of its faces is seen
};
/// @returns the edges of the faces that are seen from a point: nothing in the box hides them.
[[nodiscard]] std::vector<BoxEdge> seen_edges(const Bounds& box, const Vec3& eye);

/// @returns slices through the middle of a box, whose outline is the lines of each. @param box in the bone frame. @param size [pixels] of the edge of a slice.
[[nodiscard]] TipSlices make_middle_slices(const BoneModel& bone, const Bounds& box, int size);

}  // namespace burrhole
