#include "app/render/tip_slices_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/render/overlay.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr Rgba8 kGround{24, 28, 34, 255}, kTextGround{0, 0, 0, 255}, kHair{96, 150, 190, 255}, kTool{255, 150, 40, 255};

/// Darkens the ground of a line of text, so that no line of the drawing runs through it, and writes it.
void write_on_ground(Image& image, const std::string& text, const PixelPoint& start, double letter) {
  const double room = 0.35 * letter;
  const auto first = [](double at) { return std::max(0, static_cast<int>(std::floor(at))); };
  const int right = std::min(image.width, static_cast<int>(std::ceil(start.x + text_width(text, letter) + room)));
  const int below = std::min(image.height, static_cast<int>(std::ceil(start.y + room)));
  for (int y = first(start.y - letter - room); y < below; ++y)
    for (int x = first(start.x - room); x < right; ++x)
      image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] = kTextGround;
  draw_text(image, text, start, letter);
}

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
  const auto side = [&](char name, double x, double y) { write_on_ground(image, std::string(1, name), {x, y}, letter); };
  const double wide = text_width("R", letter);
  side(slice.left, edge, middle + 0.5 * letter);
  side(slice.right, size - edge - wide, middle + 0.5 * letter);
  side(slice.bottom, middle - 0.5 * wide, size - edge);
  side(slice.top, middle - 0.5 * wide, 3.2 * letter);
  const double at = std::round(10.0 * slice.at / kMillimetre) / 10.0 + 0.0;  // no negative zero
  write_on_ground(image, fmt::format("{}, {} = {:.1f} mm", slice.name, slice.axis, at), {edge, edge + letter}, letter);
  return image;
}

/// The three slices, the first with a scale bar.
std::array<Image, 3> draw_slices(const TipSlices& slices) {
  std::array<Image, 3> out;
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = draw_slice(slices.planes[n], slices);
  // A slice is a parallel projection; this camera at a distance of 1 m gives the scale bar the same length per pixel.
  const double height = slices.size * slices.pixel;
  const CameraView camera{
      .eye = {0.0, 0.0, 1.0}, .target = Vec3(0.0), .up = {0.0, 1.0, 0.0}, .vertical_fov = 2.0 * std::atan(0.5 * height)};
  draw_scale_bar(out.front(), fit_scale_bar(camera, slices.size, slices.size));
  return out;
}

Image make_ground(int width, int height) {
  Image out{width, height, {}};
  out.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kGround);
  return out;
}

/// Cells of the largest size, in the middle of the picture.
CellLayout make_layout(int width, int height, int columns, int rows, int below) {
  CellLayout out{width, height, columns, rows, 0, std::max(4, std::min(width, height) / 150)};
  out.size = std::max(16, std::min((width - (columns + 1) * out.gap) / columns, (height - below - (rows + 1) * out.gap) / rows));
  out.left = std::max(0, (width - columns * out.size - (columns - 1) * out.gap) / 2);
  out.top = std::max(0, (height - below - rows * out.size - (rows - 1) * out.gap) / 2);
  return out;
}

}  // namespace

void copy_into(Image& to, const Image& from, int left, int top) {
  const int first = std::max(0, -left), last = std::min(from.width, to.width - left);
  for (int y = std::max(0, -top); y < std::min(from.height, to.height - top) && first < last; ++y) {
    const auto row = from.pixels.begin() + static_cast<std::ptrdiff_t>(y) * from.width;
    std::copy(row + first, row + last, to.pixels.begin() + static_cast<std::ptrdiff_t>(y + top) * to.width + left + first);
  }
}

CellLayout fit_cells(int width, int height) {
  CellLayout best = make_layout(width, height, 3, 1, 0);
  for (const CellLayout& other : {make_layout(width, height, 2, 2, 0), make_layout(width, height, 1, 3, 0)})
    if (other.size > best.size) best = other;
  return best;
}

CellLayout square_cells(int width, int height, int below) { return make_layout(width, height, 2, 2, below); }

Image draw_tip_slices(const TipSlices& slices, const CellLayout& layout, const std::vector<std::string>& legend) {
  Image sheet = make_ground(layout.width, layout.height);
  const auto place = [&](int n) {
    return glm::dvec2(layout.left + n % layout.columns * (layout.size + layout.gap),
                      layout.top + n / layout.columns * (layout.size + layout.gap));
  };
  const std::array<Image, 3> drawn = draw_slices(slices);
  for (int n = 0; n < 3; ++n)
    copy_into(sheet, drawn[static_cast<std::size_t>(n)], static_cast<int>(place(n).x), static_cast<int>(place(n).y));
  if (layout.columns * layout.rows < 4) return sheet;
  const double letter = std::max(8.0, layout.size / 32.0);
  PixelPoint at = place(3) + PixelPoint(letter, 2.4 * letter);
  for (const std::string& line : legend) {
    draw_text(sheet, line, at, letter);
    at.y += 2.4 * letter;
  }
  return sheet;
}

Image draw_tip_slices(const TipSlices& slices) {
  const int gap = std::max(4, slices.size / 60);
  return draw_tip_slices(slices, {3 * slices.size + 4 * gap, slices.size + 2 * gap, 3, 1, slices.size, gap, gap, gap}, {});
}

}  // namespace burrhole
