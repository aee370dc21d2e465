/// app/render/overlay.h: draws lines and text on a finished picture. No OpenGL, so the bytes are the same on every machine.
///   Frame  pixels, x to the right, y down, (0, 0) the upper left corner of the upper left pixel.   Units  pixels.   Errors  none.
///   Source  own derivation; own stroke font.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/view/view.h"

namespace burrhole {

using PixelPoint = glm::dvec2;

/// A line segment with round ends.
struct Stroke {
  PixelPoint from{0.0}, to{0.0};
};

/// Draws strokes as one shape: overlaps are not denser. The coverage of a pixel decreases to 0 over one pixel from the edge of the shape.
/// @param width [pixels] > 0. Parts outside the picture are ignored.
void paint(Image& image, const std::vector<Stroke>& strokes, double width, const Rgba8& color);

/// Draws strokes with a dark rim, which separates them from any background.
void draw_rimmed(Image& image, const std::vector<Stroke>& strokes, double width, const Rgba8& color);

/// @returns the strokes of a line of text; capitals are `height` pixels high. Supported: ASCII letters, digits, blanks and . , : ; - + = /
/// ( ) %; other characters are drawn as an empty frame.
/// @param start lower left corner of the first letter, on the base line.
[[nodiscard]] std::vector<Stroke> write_text(std::string_view text, const PixelPoint& start, double height);
[[nodiscard]] double text_width(std::string_view text, double height) noexcept;  ///< [pixels]

/// Draws a line of text in white with a dark outline, readable on any background.
void draw_text(Image& image, std::string_view text, const PixelPoint& start, double height);

/// Length and label of a scale bar.
struct ScaleBar {
  double length = 0.0;  ///< [m]
  double pixels = 0.0;  ///< [pixels] length in the picture
  std::string label;    ///< "10 mm"
};

/// @returns the longest bar of 1, 2 or 5 times a power of ten millimetres that fits a quarter of the picture's width, at the distance of
/// the camera's target. At other distances a perspective picture has another scale.
[[nodiscard]] ScaleBar fit_scale_bar(const CameraView& camera, int width, int height);
/// Draws the bar into the lower left corner.
void draw_scale_bar(Image& image, const ScaleBar& bar);

}  // namespace burrhole
