#include "app/render/tip_slices_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/render/overlay.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr Rgba8 kGround{24, 28, 34, 255}, kHair{96, 150, 190, 255}, kTool{255, 150, 40, 255};

/// Draws one slice: grey values, a cross hair with a gap at the tip, the tool's outline, labels of the plane and of the four sides.
Image draw_slice(const TipSlice& slice, const TipSlices& all) {
  Image image{all.size, all.size, {}};
  for (const std::uint8_t grey : slice.grey) image.pixels.push_back({grey, grey, grey, 255});
  const double size = all.size, middle = 0.5 * size, gap = 0.04 * size;
  paint(image,
        {{{0.0, middle}, {middle - gap, middle}},
         {{middle + gap, middle}, {size, middle}},
         {{middle, 0.0}, {middle, middle - gap}},
         {{middle, middle + gap}, {middle, size}}},
        1.0, kHair);
  std::vector<Stroke> outline;
  for (const auto& stroke : slice.tool) outline.push_back({stroke[0], stroke[1]});
  paint(image, outline, std::max(1.5, size / 250.0), kTool);

  const double letter = std::max(8.0, size / 32.0), edge = 0.7 * letter;
  const auto side = [&](char name, double x, double y) { draw_text(image, std::string(1, name), {x, y}, letter); };
  const double wide = text_width("R", letter);
  side(slice.left, edge, middle + 0.5 * letter);
  side(slice.right, size - edge - wide, middle + 0.5 * letter);
  side(slice.bottom, middle - 0.5 * wide, size - edge);
  side(slice.top, middle - 0.5 * wide, 3.2 * letter);
  const double at = std::round(10.0 * slice.at / kMillimetre) / 10.0 + 0.0;  // no negative zero
  draw_text(image, fmt::format("{}, {} = {:.1f} mm", slice.name, slice.axis, at), {edge, edge + letter}, letter);
  return image;
}

}  // namespace

Image draw_tip_slices(const TipSlices& slices) {
  const int gap = std::max(4, slices.size / 60);
  Image sheet{3 * slices.size + 4 * gap, slices.size + 2 * gap, {}};
  sheet.pixels.assign(static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), kGround);
  for (std::size_t n = 0; n < 3; ++n) {
    Image slice = draw_slice(slices.planes[n], slices);
    if (n == 0) {
      // A slice is a parallel projection; this camera at a distance of 1 m gives the scale bar the same length per pixel.
      const double height = slices.size * slices.pixel;
      const CameraView camera{
          .eye = {0.0, 0.0, 1.0}, .target = Vec3(0.0), .up = {0.0, 1.0, 0.0}, .vertical_fov = 2.0 * std::atan(0.5 * height)};
      draw_scale_bar(slice, fit_scale_bar(camera, slices.size, slices.size));
    }
    const std::size_t left = static_cast<std::size_t>(gap) + n * static_cast<std::size_t>(slices.size + gap);
    for (int y = 0; y < slices.size; ++y) {
      const auto row = slice.pixels.begin() + static_cast<std::ptrdiff_t>(y) * slices.size;
      std::copy(row, row + slices.size,
                sheet.pixels.begin() +
                    static_cast<std::ptrdiff_t>((static_cast<std::size_t>(y + gap) * static_cast<std::size_t>(sheet.width)) + left));
    }
  }
  return sheet;
}

}  // namespace burrhole
