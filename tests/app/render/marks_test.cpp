// Marks on finished pictures: the directions of the patient, cells of a sheet.
#include "app/render/marks.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <string>

#include "app/render/tip_slices_picture.h"

using namespace burrhole;

namespace {

PatientDirection direction(const std::array<PatientDirection, 6>& all, char letter) {
  return *std::ranges::find(all, letter, &PatientDirection::letter);
}

}  // namespace

TEST_CASE("orientation: seen from anterior, the patient's left is on the right and superior is up") {
  const CameraView camera{.eye = {0.0, -0.5, 0.0}, .target = Vec3(0.0)};
  const auto seen = patient_directions(camera, Pose{});
  CHECK(glm::length(direction(seen, 'L').end - glm::dvec2(1.0, 0.0)) < 1e-12);
  CHECK(glm::length(direction(seen, 'R').end - glm::dvec2(-1.0, 0.0)) < 1e-12);
  CHECK(glm::length(direction(seen, 'S').end - glm::dvec2(0.0, 1.0)) < 1e-12);
  CHECK(direction(seen, 'A').depth == doctest::Approx(1.0));
  CHECK(seen.front().letter == 'P');  // the farthest is drawn first
  CHECK(seen.back().letter == 'A');
}

TEST_CASE("orientation: it follows the pose of the bone and has unit axes in every view") {
  const double half = 0.25 * std::numbers::pi;  // a quarter turn about z: the patient's x becomes the world's y
  const Pose turned{Quat(std::cos(half), 0.0, 0.0, std::sin(half)), Vec3(0.1, 0.2, 0.3)};
  const CameraView camera{.eye = {0.3, -0.4, 0.2}, .target = {0.01, 0.02, 0.0}};
  const auto plain = patient_directions(camera, Pose{}), after = patient_directions(camera, turned);
  CHECK(glm::length(direction(after, 'L').end - direction(plain, 'P').end) < 1e-12);
  for (const auto& one : after) CHECK(glm::dot(one.end, one.end) + one.depth * one.depth == doctest::Approx(1.0));
}

TEST_CASE("orientation: a mark changes the lower right corner and nothing else") {
  Image image{400, 300, std::vector<Rgba8>(400 * 300, Rgba8{90, 90, 90, 255})};
  const std::vector<Rgba8> before = image.pixels;
  draw_orientation(image, {.eye = {0.3, -0.4, 0.2}, .target = Vec3(0.0)}, Pose{});
  int inside = 0, outside = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x)
      if (const auto n = static_cast<std::size_t>(400 * y + x); !(image.pixels[n] == before[n])) (x > 300 && y > 200 ? inside : outside)++;
  CHECK(inside > 50);
  CHECK(outside == 0);
}

TEST_CASE("cells: the layout has the picture's size, its cells do not overlap and are as large as fits") {
  for (const auto& [width, height] : {std::pair(1200, 900), std::pair(1600, 500), std::pair(400, 1300), std::pair(64, 64)}) {
    const CellLayout layout = fit_cells(width, height);
    CHECK(layout.columns * layout.rows >= 3);
    CHECK(layout.left >= 0);
    CHECK(layout.top >= 0);
    CHECK(layout.left + layout.columns * (layout.size + layout.gap) - layout.gap <= width);
    CHECK(layout.top + layout.rows * (layout.size + layout.gap) - layout.gap <= height);
  }
  CHECK(fit_cells(1600, 500).rows == 1);
  CHECK(fit_cells(400, 1300).columns == 1);
  CHECK(fit_cells(1200, 900).columns == 2);
}

TEST_CASE("cells: slices are placed in a picture of exactly the size asked for") {
  TipSlices slices{.size = fit_cells(320, 200).size, .pixel = 1e-3, .planes = {}};
  const auto pixels = static_cast<std::size_t>(slices.size) * static_cast<std::size_t>(slices.size);
  for (std::size_t n = 0; n < 3; ++n)
    slices.planes[n] = {"axial", 'z', 0.0, 'R', 'L', 'A', 'P', std::vector<std::uint8_t>(pixels, 200), {}};
  const CellLayout layout = fit_cells(320, 200);
  const Image image = draw_tip_slices(slices, layout, {"legend"});
  CHECK(image.width == 320);
  CHECK(image.height == 200);
  CHECK(image.pixels.size() == 320u * 200u);
  const auto bright = std::ranges::count_if(image.pixels, [](const Rgba8& p) { return p.r == 200 && p.g == 200; });
  CHECK(bright > static_cast<std::ptrdiff_t>(2 * pixels));
}
