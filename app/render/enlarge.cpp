#include "app/render/enlarge.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

/// Position of a pixel of the large picture in the small one: between two of its pixels.
struct Place {
  std::size_t before = 0, after = 0;
  double share = 0.0;  ///< [-] of the second pixel
};

std::vector<Place> places(int large, int small) {
  std::vector<Place> out;
  for (int n = 0; n < large; ++n) {
    const double at = std::clamp((n + 0.5) * small / large - 0.5, 0.0, small - 1.0);
    const double before = std::floor(at);
    out.push_back({static_cast<std::size_t>(before), static_cast<std::size_t>(std::min(before + 1.0, small - 1.0)), at - before});
  }
  return out;
}

}  // namespace

Image enlarge(Image image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  const std::vector<Place> columns = places(width, image.width), rows = places(height, image.height);
  const auto row_length = static_cast<std::size_t>(image.width);
  Image out{width, height, {}};
  out.pixels.reserve(columns.size() * rows.size());
  for (const Place& row : rows)
    for (const Place& column : columns) {
      const auto mixed = [&](std::uint8_t Rgba8::*channel) {
        const auto at = [&](std::size_t y, std::size_t x) { return static_cast<double>(image.pixels[y * row_length + x].*channel); };
        const auto along = [&](std::size_t y) {
          return at(y, column.before) + column.share * (at(y, column.after) - at(y, column.before));
        };
        return static_cast<std::uint8_t>(along(row.before) + row.share * (along(row.after) - along(row.before)) + 0.5);
      };
      out.pixels.push_back({mixed(&Rgba8::r), mixed(&Rgba8::g), mixed(&Rgba8::b), 255});
    }
  return out;
}

Image shrink(const Image& large, int n) {
  Image image{large.width / n, large.height / n, {}};
  image.pixels.reserve(large.pixels.size() / static_cast<std::size_t>(n * n));
  const auto mean = [n](int sum) { return static_cast<std::uint8_t>((sum + n * n / 2) / (n * n)); };
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      glm::ivec3 sum(0);
      for (int part = 0; part < n * n; ++part) {
        const int y = row * n + part / n, x = column * n + part % n;
        const Rgba8& p = large.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(large.width) + static_cast<std::size_t>(x)];
        sum += glm::ivec3(p.r, p.g, p.b);
      }
      image.pixels.push_back({mean(sum.x), mean(sum.y), mean(sum.z), 255});
    }
  return image;
}

}  // namespace burrhole
