/// app/render/overlay.h: lines and lettering on a finished picture. No OpenGL: what is drawn here needs no driver and has the same bytes anywhere.
///   Frame  pixels, x to the right, y down, (0, 0) the upper left corner of the upper left pixel.   Source  own derivation; own stroke font.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/engine/view.h"

namespace burrhole {

using PixelPoint = glm::dvec2;

/// A straight stroke with round ends.
struct Stroke {
  PixelPoint from{0.0}, to{0.0};
};

/// Paints strokes as one shape: where they overlap they are no denser. A pixel's coverage falls over one pixel from the shape's edge.
/// @param width [pixels] > 0. What lies outside the picture is left out.
void paint(Image& image, const std::vector<Stroke>& strokes, double width, const Rgba8& color);

/// Strokes of a line of text. Capitals are `height` pixels high. Knows ASCII letters, digits and the signs . , : ; - + = / ( ) and %; any
/// other is an empty frame.
/// @param start lower left corner of the first letter, on the base line.
[[nodiscard]] std::vector<Stroke> write_text(std::string_view text, const PixelPoint& start, double height);
[[nodiscard]] double text_width(std::string_view text, double height) noexcept;  ///< [pixels]

/// A line of text in white with a dark rim, readable on any ground.
void draw_text(Image& image, std::string_view text, const PixelPoint& start, double height);

/// How long a scale bar is, and what it says.
struct ScaleBar {
  double length = 0.0;  ///< [m]
  double pixels = 0.0;  ///< what that is in the picture
  std::string label;    ///< "10 mm"
};

/// The longest of 1, 2 or 5 times a power of ten millimetres that fits into a quarter of the picture's width, as it looks at the distance
/// of the point looked at; elsewhere in a perspective picture a length looks longer or shorter.
[[nodiscard]] ScaleBar fit_scale_bar(const CameraView& camera, int width, int height);
/// Draws it into the lower left corner.
void draw_scale_bar(Image& image, const ScaleBar& bar);

}  // namespace burrhole
