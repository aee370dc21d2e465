/// app/view/stereo.h: cameras of two eyes with off-axis frusta, and their pictures combined into one. No OpenGL.
///   Frame  world; pictures: row 0 is the top.   Units  SI.   Errors  out_of_range.
///   Source the haptic workbench of [AcostaLiu07], where picture and forces coincide; cameras and parallax are own derivations, shown here.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// @returns left and right camera. Both view along the camera's direction (no toe-in: no vertical parallax), displaced by half of
/// `separation` to either side, with frusta shifted so that a point on the plane at depth `screen` has the same position in both pictures.
/// A point at depth z is displaced in the right picture by separation * (1/screen - 1/z) to the right, in metres at depth 1 m.
/// @param aspect width / height of one eye's picture. ErrorCode::out_of_range unless separation >= 0 and screen > 0 are finite, and errors
/// of make_camera_rays().
[[nodiscard]] Result<std::array<CameraView, 2>> make_stereo_cameras(const CameraView& camera, const StereoView& stereo, double aspect);

/// A flat screen in space: the origin of the pose is its middle, x to the right, y up, z towards the viewer.
struct ScreenView {
  Pose world_from_screen;
  double width = 0.0, height = 0.0;  ///< [m]
};

/// @returns the camera of an eye that sees the world through the screen as through a window: a virtual point appears at its position, and
/// the corners of the picture are those of the screen for every position of the eye.
/// ErrorCode::out_of_range if a value is not finite, the screen has no size, or the eye is not in front of the screen.
[[nodiscard]] Result<CameraView> make_screen_camera(const Vec3& eye, const ScreenView& screen);
/// @returns left and right camera of a tracked head: the origin of the pose is midway between the eyes, x to the right. @param separation
/// [m] of the pupils.
[[nodiscard]] Result<std::array<CameraView, 2>> make_workbench_cameras(const Pose& world_from_head, double separation,
                                                                       const ScreenView& screen);

/// @returns the word of [display] stereo for a mode, and the mode of a word; off for a word that is none.
[[nodiscard]] const char* stereo_name(StereoMode mode) noexcept;
[[nodiscard]] StereoMode stereo_mode(std::string_view name) noexcept;

/// @returns the cameras of one picture: one, or left and right if the mode asks for two eyes; those of the workbench if there is one.
/// @param aspect width / height of one eye's picture. Errors as above.
[[nodiscard]] Result<std::vector<CameraView>> make_eye_cameras(const CameraView& camera, const StereoView& stereo, double aspect);
/// @returns the picture of one or two eyes as the screen is to show it: joined, and upside down for a mirror. @param eyes as many as cameras.
/// @pre the mode is not quad.
[[nodiscard]] Image make_screen_picture(const StereoView& stereo, std::vector<Image> eyes);
/// @returns what the buffers of the screen show: left and right picture of the mode quad, otherwise make_screen_picture() alone.
[[nodiscard]] std::vector<Image> make_buffer_pictures(const StereoView& stereo, std::vector<Image> eyes);

/// @returns one picture of two with equal size: twice as wide (left eye left), twice as high (left eye on top), or, as an anaglyph for red
/// and cyan glasses, of equal size: red is the left eye's luma (ITU-R BT.601), green and blue are those of the right eye.
[[nodiscard]] Image join_eyes(StereoMode mode, const Image& left, const Image& right);

}  // namespace burrhole
