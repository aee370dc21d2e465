// Lines, lettering and scale bars on finished pictures.
#include "app/render/overlay.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/view/camera.h"

using namespace burrhole;

namespace {

constexpr Rgba8 kBlack{0, 0, 0, 255}, kWhite{255, 255, 255, 255};

Image blank(int width, int height) {
  return {width, height, std::vector<Rgba8>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kBlack)};
}

const Rgba8& pixel(const Image& image, int x, int y) {
  return image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
}

/// White ink [pixels] on black ground.
double ink(const Image& image) {
  double sum = 0.0;
  for (const Rgba8& p : image.pixels) sum += p.r / 255.0;
  return sum;
}

}  // namespace

TEST_CASE("overlay: a stroke covers its length times its width, and its round ends") {
  Image image = blank(80, 60);
  paint(image, {{{15.5, 20.2}, {60.5, 41.7}}}, 4.0, kWhite);
  const double length = std::hypot(45.0, 21.5);
  // Coverage by distance to the edge is exact for edges along the grid; on slanted ones it is off by under a hundredth of a pixel's width.
  CHECK(ink(image) == doctest::Approx(length * 4.0 + 3.14159265 * 4.0).epsilon(0.01));
}

TEST_CASE("overlay: strokes that overlap are one shape, and what lies outside the picture is left out") {
  Image once = blank(40, 40), twice = blank(40, 40);
  const Stroke stroke{{-30.0, 20.0}, {70.0, 22.0}};
  paint(once, {stroke}, 3.3, kWhite);
  paint(twice, {stroke, stroke}, 3.3, kWhite);
  CHECK(once.pixels == twice.pixels);
  CHECK(ink(once) == doctest::Approx(40.0 * 3.3 * std::hypot(100.0, 2.0) / 100.0).epsilon(0.01));
  Image outside = blank(10, 10);
  paint(outside, {{{-50.0, -50.0}, {-20.0, 500.0}}, {{1e12, 0.0}, {2e12, 4.0}}}, 2.0, kWhite);
  CHECK(ink(outside) == 0.0);
}

TEST_CASE("overlay: text stays in its box, and every sign differs from every other") {
  const std::string signs = "0123456789.,:;-+=/()%abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNPQRSTUVWXYZ#";
  std::set<std::vector<std::uint8_t>> drawn;
  for (const char sign : signs) {
    Image image = blank(40, 60);
    paint(image, write_text(std::string(1, sign), {10.0, 40.0}, 30.0), 2.0, kWhite);
    std::vector<std::uint8_t> grey;
    for (const Rgba8& p : image.pixels) grey.push_back(p.r);
    CAPTURE(sign);
    CHECK(ink(image) > 2.0);
    CHECK(drawn.insert(grey).second);
    // Descenders reach a third of the height below the base line.
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 40; ++x)
        if (x < 8 || x > 10 + 20 + 2 || y < 8 || y > 52) REQUIRE(pixel(image, x, y).r == 0);
  }
  CHECK(write_text(" ", {0, 0}, 10.0).empty());
  const auto strokes = write_text("HH", {5.0, 20.0}, 12.0);
  double right = 0.0;
  for (const Stroke& stroke : strokes) right = std::max({right, stroke.from.x, stroke.to.x});
  CHECK(right == doctest::Approx(5.0 + text_width("HH", 12.0)));
}

TEST_CASE("scale bar: its ends are as far apart as the projection of its length at the target") {
  const CameraView camera{.eye = {0.03, -0.05, 0.06}, .target = {0.001, 0.002, -0.003}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.6};
  for (const auto& [width, height] : {std::pair(1200, 900), std::pair(400, 700), std::pair(64, 16)}) {
    const ScaleBar bar = fit_scale_bar(camera, width, height);
    const auto rays = make_camera_rays(camera, static_cast<double>(width) / height);
    REQUIRE(rays.ok());
    const glm::dmat4 clip = clip_from_world(*rays, {0.01, 1.0});
    const Vec3 side = glm::normalize(rays->right);
    const auto column = [&](const Vec3& p) {
      const glm::dvec4 c = clip * glm::dvec4(p, 1.0);
      return 0.5 * (c.x / c.w + 1.0) * width;
    };
    CHECK(bar.pixels == doctest::Approx(column(camera.target + bar.length * side) - column(camera.target)));
    CHECK(bar.pixels <= 0.25 * width);
    CHECK(bar.pixels > 0.1 * width);  // of 1, 2 and 5 the next is at most 2.5 times as long
  }
  CHECK(fit_scale_bar(camera, 1200, 900).label == "10 mm");
}

TEST_CASE("scale bar: drawn as long as it says, white with a dark rim") {
  Image image{600, 400, std::vector<Rgba8>(600 * 400, Rgba8{128, 128, 128, 255})};
  draw_scale_bar(image, {.length = 5e-3, .pixels = 123.0, .label = "5 mm"});
  // The longest run of white along a row is the bar, a line width longer with its round ends.
  int longest = 0;
  for (int y = 0; y < image.height; ++y) {
    int run = 0;
    for (int x = 0; x < image.width; ++x) {
      run = pixel(image, x, y).r > 200 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  CHECK(longest >= 123);
  CHECK(longest <= 127);
  CHECK(std::any_of(image.pixels.begin(), image.pixels.end(), [](const Rgba8& p) { return p.r < 40; }));
}
