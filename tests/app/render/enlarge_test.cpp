#include "app/render/enlarge.h"

#include <doctest/doctest.h>

using namespace burrhole;

namespace {

Image ramp(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.pixels.push_back({static_cast<std::uint8_t>(20 * x), static_cast<std::uint8_t>(10 * y), 7, 255});
  return image;
}

}  // namespace

TEST_CASE("enlarge: the same size is the same picture") {
  const Image image = ramp(5, 4);
  CHECK(enlarge(image, 5, 4).pixels == image.pixels);
}

TEST_CASE("enlarge: a ramp stays a ramp between the outermost pixels, which go on beyond their middles") {
  const Image large = enlarge(ramp(8, 6), 16, 24);
  REQUIRE((large.width == 16 && large.height == 24 && large.pixels.size() == 16u * 24u));
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 16; ++x) {
      const Rgba8& p = large.pixels[static_cast<std::size_t>(16 * y + x)];
      CHECK(std::abs(p.r - 20.0 * std::clamp((x + 0.5) / 2.0 - 0.5, 0.0, 7.0)) <= 0.5);
      CHECK(std::abs(p.g - 10.0 * std::clamp((y + 0.5) / 4.0 - 0.5, 0.0, 5.0)) <= 0.5);
      CHECK(p.b == 7);
      CHECK(p.a == 255);
    }
}

TEST_CASE("enlarge: a picture of one pixel is plain") {
  for (const Rgba8& p : enlarge(ramp(1, 1), 3, 2).pixels) CHECK(p == Rgba8{0, 0, 7, 255});
}
