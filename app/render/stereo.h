/// app/render/stereo.h: two eyes: their cameras by off-axis frusta, and their pictures joined into one. No OpenGL.
///   Frame  world; pictures: row 0 is the top.   Units  SI.
///   Source the haptic workbench of [AcostaLiu07], whose picture lies where its forces are; cameras and parallax are own derivations, shown here.
#pragma once

#include <array>

#include "app/engine/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Left and right. Both look along the camera's direction (no toe-in: a point has no vertical parallax), half of `separation` to either
/// side of it, with frusta shifted so that both see the plane at depth `screen` at one place. A point at depth z then lies, in the right
/// eye's picture, separation * (1/screen - 1/z) to the right of where the left eye sees it, in metres at depth 1 m.
/// @param aspect width / height of one eye's picture. @returns ErrorCode::out_of_range unless separation >= 0 and screen > 0 are finite,
/// and whatever make_camera_rays() refuses.
[[nodiscard]] Result<std::array<CameraView, 2>> make_stereo_cameras(const CameraView& camera, const StereoView& stereo, double aspect);

/// A flat screen in space: the pose's origin is its middle, x to the right, y up, z towards the viewer.
struct ScreenView {
  Pose world_from_screen;
  double width = 0.0, height = 0.0;  ///< [m]
};

/// The camera of an eye that sees the world through the screen as through a window, so that a virtual point appears where it is: the
/// screen's corners are the picture's corners, wherever the eye is.
/// @returns ErrorCode::out_of_range if a value is not finite, the screen has no size, or the eye is not before it.
[[nodiscard]] Result<CameraView> make_screen_camera(const Vec3& eye, const ScreenView& screen);
/// Left and right, of a measured head: the pose's origin lies midway between the eyes, x to the right. @param separation [m] of the pupils.
[[nodiscard]] Result<std::array<CameraView, 2>> make_workbench_cameras(const Pose& world_from_head, double separation,
                                                                       const ScreenView& screen);

/// One picture of two of one size: twice as wide (left eye on the left), twice as high (left eye on top), or, as an anaglyph for red and
/// cyan glasses, of the same size: red is the left eye's luma (ITU-R BT.601), green and blue are the right eye's.
[[nodiscard]] Image join_eyes(StereoMode mode, const Image& left, const Image& right);

}  // namespace burrhole
