/// app/render/marks.h: marks that are drawn on a finished picture: the directions of the patient, the box around a bone. No OpenGL.
///   Frame  as each function states; pixels as overlay.h.   Units  SI; pixels.   Errors  none: a camera that is invalid draws nothing.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/view/color_bar.h"
#include "app/view/view.h"
#include "app/view/whole_bone.h"
#include "core/base/bounds.h"

namespace burrhole {

/// A half axis of the orientation mark.
struct PatientDirection {
  char letter = 'L';
  glm::dvec2 end{0.0};  ///< [-] in the picture, x right, y up, 1 = the radius of the mark
  double depth = 0.0;   ///< [-] towards the viewer
};
/// @returns the six directions A P L R S I as a camera sees them, by parallel projection, the farthest first.
[[nodiscard]] std::array<PatientDirection, 6> patient_directions(const CameraView& camera, const Pose& world_from_patient);
inline constexpr double kMarkRadius = 2.3;  ///< [letter heights] of the orientation mark
/// @returns where the letters of the directions stand, in the same order: their middles [letter heights] from the middle of the mark, x
/// right, y up. No letter is near another or on the axis of another; nothing for a direction that is too short in the picture.
[[nodiscard]] std::array<std::optional<glm::dvec2>, 6> place_letters(const std::array<PatientDirection, 6>& directions);
/// Draws them into the lower right corner.
void draw_orientation(Image& image, const CameraView& camera, const Pose& world_from_patient);

/// Draws text at the lower edge, between scale bar and directions; where it would be too small to read, in lines in the upper left corner.
void draw_note(Image& image, const std::string& text);
/// Draws a scale of colours at the left edge, its lower end below, with its marks and its title above it.
void draw_color_bar(Image& image, const ColorBar& bar);
/// Copies a small picture into the upper right corner, with a light frame.
void frame_into(Image& image, const Image& small);

/// Draws the seen edges of a box with the lengths of three of them.
void draw_box(Image& image, const CameraView& camera, const Bounds& box);

}  // namespace burrhole
