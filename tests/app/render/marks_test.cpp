// Marks on finished pictures: the directions of the patient, cells of a sheet.
#include "app/render/marks.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>

#include "app/render/overlay.h"
#include "app/render/tip_slices_picture.h"
#include "app/view/camera.h"
#include "core/base/color_ramp.h"

using namespace burrhole;

namespace {

PatientDirection direction(const std::array<PatientDirection, 6>& all, char letter) {
  return *std::ranges::find(all, letter, &PatientDirection::letter);
}

constexpr Rgba8 kGrey{90, 90, 90, 255}, kWhite{250, 250, 250, 255}, kBox{255, 214, 120, 255};

Image blank(int width, int height) {
  return {width, height, std::vector<Rgba8>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kGrey)};
}

Rgba8 at(const Image& image, double x, double y) {
  const int column = std::clamp(static_cast<int>(std::floor(x)), 0, image.width - 1),
            row = std::clamp(static_cast<int>(std::floor(y)), 0, image.height - 1);
  return image.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(column)];
}

/// Whether a point is at most a pixel from one that has two fifths of the way from the grey to a colour: lines are hardly wider than a pixel.
bool has_color(const Image& image, const PixelPoint& p, const Rgba8& color) {
  const auto reaches = [](int value, int whole) { return 5 * (value - kGrey.r) > 2 * (whole - kGrey.r); };
  for (const double y : {-1.0, 0.0, 1.0})
    for (const double x : {-1.0, 0.0, 1.0})
      if (const Rgba8 pixel = at(image, p.x + x, p.y + y); reaches(pixel.r, color.r) && reaches(pixel.g, color.g)) return true;
  return false;
}

/// Where a text is found best.
struct FoundText {
  PixelPoint start{0.0};  ///< [pixels] lower left corner, to a pixel
  double share = 0.0;     ///< [-] of its strokes that have the colour; 0 below nine tenths
};
FoundText find_text(const Image& image, const std::string& text, double height, const Rgba8& color) {
  std::vector<PixelPoint> points;
  for (const Stroke& stroke : write_text(text, PixelPoint(0.0), height)) {
    const int steps = 1 + static_cast<int>(glm::length(stroke.to - stroke.from));
    for (int n = 0; n <= steps; ++n) points.push_back(glm::mix(stroke.from, stroke.to, static_cast<double>(n) / steps));
  }
  std::vector<std::uint8_t> colored;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) colored.push_back(has_color(image, {x + 0.5, y + 0.5}, color) ? 1 : 0);
  FoundText best;
  for (int y = static_cast<int>(1.5 * height); y < image.height - static_cast<int>(0.4 * height); ++y)
    for (int x = 0; x + text_width(text, height) + 1.0 < image.width; ++x) {
      std::size_t missing = 0;
      for (std::size_t n = 0; n < points.size() && 10 * missing <= points.size(); ++n) {
        const int column = static_cast<int>(x + points[n].x), row = static_cast<int>(std::floor(y + points[n].y));
        missing +=
            colored[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(column)] != 0 ? 0 : 1;
      }
      const double share = 1.0 - static_cast<double>(missing) / static_cast<double>(points.size());
      if (10 * missing <= points.size() && share > best.share) best = {{x, y}, share};
    }
  return best;
}

/// @returns where a picture differs from a blank one.
std::vector<bool> ink(const Image& image) {
  std::vector<bool> out;
  for (const Rgba8& p : image.pixels) out.push_back(!(p == kGrey));
  return out;
}

int count_both(const std::vector<bool>& a, const std::vector<bool>& b) {
  int out = 0;
  for (std::size_t n = 0; n < a.size(); ++n) out += a[n] && b[n] ? 1 : 0;
  return out;
}

constexpr double kRead = 0.985;  ///< [-] share of strokes of a text that is there; one other letter takes more than the rest
constexpr const char* kNote = "layers by density; dura and brain assumed";

}  // namespace

TEST_CASE("note: its words are in the picture, at least 7 pixels high, and on no other mark") {
  for (const auto& [width, height] :
       {std::pair(1200, 900), std::pair(720, 540), std::pair(640, 480), std::pair(300, 360), std::pair(300, 225)}) {
    CAPTURE(width);
    Image note = blank(width, height), bar = note, mark = note, inset = note;
    draw_note(note, kNote);
    const CameraView camera{.eye = {0.3, -0.4, 0.2}, .target = Vec3(0.0)};
    draw_scale_bar(bar, fit_scale_bar(camera, width, height));
    draw_orientation(mark, camera, Pose{});
    frame_into(inset, blank(width / 4, height / 4));
    CHECK(count_both(ink(note), ink(bar)) == 0);
    CHECK(count_both(ink(note), ink(mark)) == 0);
    CHECK(count_both(ink(note), ink(inset)) == 0);
    // All of it between the other marks, or its beginning and its end in the upper left corner, in one line or two.
    const double usual = std::max(7.0, 0.8 * std::clamp(height / 50.0, 7.0, 40.0));
    const double fitting = std::min(usual, usual * 0.42 * width / text_width(kNote, usual));
    const bool whole = fitting >= 7.0 && find_text(note, kNote, fitting, kWhite).share > kRead;
    if (!whole) {
      const auto first = find_text(note, "layers by density;", usual, kWhite), last = find_text(note, "assumed", usual, kWhite);
      CHECK(first.share > kRead);
      CHECK(last.share > kRead);
      const bool below = last.start.y > first.start.y + 1.4 * usual;
      CHECK((below || last.start.x > first.start.x + text_width("layers by density;", usual)));
    }
    CHECK(find_text(note, "dura measured", usual, kWhite).share < kRead);
  }
}

TEST_CASE("inset: a small picture is copied into the upper right corner, with a frame, and nothing else is changed") {
  Image image = blank(400, 300);
  Image small{100, 75, {}};
  for (int n = 0; n < 100 * 75; ++n)
    small.pixels.push_back({static_cast<std::uint8_t>(n % 251), static_cast<std::uint8_t>(n % 241), 7, 255});
  frame_into(image, small);
  constexpr int kGap = 5, kLeft = 400 - 100 - kGap;  // a sixtieth of the height
  int wrong = 0, changed = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x) {
      const bool inner = x >= kLeft + 2 && x < kLeft + 98 && y >= kGap + 2 && y < kGap + 73;
      const bool near = x >= kLeft - 3 && x < kLeft + 103 && y >= kGap - 3 && y < kGap + 78;
      if (inner && !(at(image, x, y) == small.pixels[static_cast<std::size_t>((y - kGap) * 100 + x - kLeft)])) ++wrong;
      if (!near && !(at(image, x, y) == kGrey)) ++changed;
    }
  CHECK(wrong == 0);
  CHECK(changed == 0);
  for (const double x : {kLeft + 0.0, kLeft + 99.9}) CHECK(at(image, x, kGap + 40).b > 120);  // the frame
  for (const double y : {kGap + 0.0, kGap + 74.9}) CHECK(at(image, kLeft + 50, y).b > 120);
}

TEST_CASE("box: its seen edges are drawn, hidden ones are not, and three of them have their lengths") {
  const Bounds box{{-0.07, -0.09, -0.05}, {0.07, 0.09, 0.06}};
  const CameraView camera{.eye = {0.35, -0.5, 0.3}, .target = Vec3(0.0), .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.6};
  Image image = blank(640, 480);
  draw_box(image, camera, box);
  const auto rays = make_camera_rays(camera, 640.0 / 480.0);
  REQUIRE(rays.ok());
  const glm::dmat4 clip = clip_from_world(*rays, {0.01, 10.0});
  const auto pixel = [&](const Vec3& p) {
    const glm::dvec4 seen = clip * glm::dvec4(p, 1.0);
    return PixelPoint(0.5 * (1.0 + seen.x / seen.w) * 640.0, 0.5 * (1.0 - seen.y / seen.w) * 480.0);
  };
  // From +x, -y, +z: edges that touch none of these faces are hidden.
  int seen = 0, hidden = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      Vec3 p(0.0);
      p[a] = (side & 1) != 0 ? box.hi[a] : box.lo[a];
      p[b] = (side & 2) != 0 ? box.hi[b] : box.lo[b];
      const bool is_seen = (axis != 0 && p.x == box.hi.x) || (axis != 1 && p.y == box.lo.y) || (axis != 2 && p.z == box.hi.z);
      int drawn = 0;
      for (int n = 1; n < 40; ++n) {
        p[axis] = glm::mix(box.lo[axis], box.hi[axis], n / 40.0);
        drawn += has_color(image, pixel(p), kBox) ? 1 : 0;
      }
      if (is_seen) CHECK(drawn > 28);  // a length may lie on it
      if (!is_seen) CHECK(drawn < 5);  // where a seen edge or a length is before it
      ++(is_seen ? seen : hidden);
    }
  CHECK(seen == 9);
  CHECK(hidden == 3);
  for (const char* length : {"R-L 140.0 mm", "A-P 180.0 mm", "I-S 110.0 mm"})
    CHECK_MESSAGE(find_text(image, length, 9.6, kBox).share > kRead, std::string(length));
  CHECK(find_text(image, "R-L 180.0 mm", 9.6, kBox).share < kRead);
}

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

TEST_CASE("orientation: no letter is on another or on the axis of another, from any side") {
  const auto to_axis = [](const glm::dvec2& p, const glm::dvec2& end) {
    const double squared = glm::dot(end, end);
    return glm::length(p - (squared > 0.0 ? std::clamp(glm::dot(p, end) / squared, 0.0, 1.0) : 0.0) * end);
  };
  double letters = 1e9, axes = 1e9, own = 0.0;
  constexpr int kSides = 3000;
  for (int n = 0; n < kSides; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / kSides, turn = 2.399963 * n, flat = std::sqrt(1.0 - z * z);  // a spiral over the sphere
    const double roll = 0.7 * n;
    const Vec3 eye(flat * std::cos(turn), flat * std::sin(turn), z);
    const Vec3 up(std::cos(roll) * 0.3, std::sin(roll) * 0.3, 1.0);
    const auto directions = patient_directions({.eye = 0.4 * eye, .target = Vec3(0.0), .up = up}, Pose{});
    const auto places = place_letters(directions);
    for (std::size_t a = 0; a < 6; ++a) {
      CHECK(places[a].has_value() == (glm::length(directions[a].end) >= 0.3));
      if (!places[a]) continue;
      own = std::max(own, glm::length(*places[a] - kMarkRadius * directions[a].end));
      for (std::size_t b = 0; b < 6; ++b) {
        if (b == a) continue;
        axes = std::min(axes, to_axis(*places[a], kMarkRadius * directions[b].end));
        if (places[b]) letters = std::min(letters, glm::length(*places[a] - *places[b]));
      }
    }
  }
  // [letter heights] A letter is 1 high and two thirds wide: their diagonals are 1.2, so two that are 1.9 apart have more than half a letter between.
  CHECK(letters > 1.9);
  CHECK(axes > 0.6);
  CHECK(own < 2.5);
}

TEST_CASE("slices: no line of the drawing runs through a title or a letter of a side") {
  TipSlices slices{.size = 320, .pixel = 1e-4, .planes = {}};
  for (std::size_t n = 0; n < 3; ++n) {
    slices.planes[n] = {"axial", 'z', 0.0, 'R', 'L', 'A', 'P', std::vector<std::uint8_t>(320 * 320, 90), {}};
    for (int x = 2; x < 320; x += 6) slices.planes[n].tool.push_back({glm::dvec2(x, 0.0), glm::dvec2(x, 320.0)});
  }
  const Image image = draw_tip_slices(slices);
  const auto title = find_text(image, "axial, z = 0.0 mm", 10.0, kWhite);
  CHECK(title.share > kRead);
  int orange = 0;
  for (double y = title.start.y - 10.0; y < title.start.y; y += 1.0)
    for (double x = title.start.x; x < title.start.x + text_width("axial, z = 0.0 mm", 10.0); x += 1.0)
      orange += at(image, x, y).r > at(image, x, y).b + 60 ? 1 : 0;
  CHECK(orange == 0);
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

TEST_CASE(
    "color bar: it has the ramp from its lower to its upper end, a tick at each mark and its texts; in small pictures it stays inside") {
  Image image = blank(600, 450);
  draw_color_bar(image, {.title = "temperature (C)", .marks = {{0.0, "40"}, {0.5, "50"}, {1.0, "60"}}});
  const double letter = 9.0, middle = 1.6 * letter + 0.6 * letter, top = 0.3 * 450.0, bottom = 0.7 * 450.0;
  for (const double share : {0.02, 0.3, 0.5, 0.8, 0.98}) {
    const Rgba8 pixel = at(image, middle, bottom + share * (top - bottom));
    const RampColor below = ramp_color(share - 0.006), above = ramp_color(share + 0.006);  // a row is 1/180 of it
    CHECK(pixel.g >= below.g);
    CHECK(pixel.g <= above.g);
  }
  const auto changed = [&](double x0, double y0, double x1, double y1) {
    int out = 0;
    for (double y = y0; y < y1; ++y)
      for (double x = x0; x < x1; ++x) out += at(image, x, y) == kGrey ? 0 : 1;
    return out;
  };
  for (const double share : {0.0, 0.5, 1.0}) {
    const double y = bottom + share * (top - bottom);
    CHECK(changed(3.7 * letter, y - 0.6 * letter, 6.0 * letter, y + 0.6 * letter) > 20);
  }
  CHECK(changed(letter, top - 2.2 * letter, 12.0 * letter, top - 0.9 * letter) > 50);  // the title
  CHECK(changed(3.7 * letter, bottom + 0.25 * (top - bottom) - 3.0, 6.0 * letter, bottom + 0.25 * (top - bottom) + 3.0) == 0);
  for (const int size : {1, 16, 40}) {
    Image small = blank(size, size);
    draw_color_bar(small, {.title = "temperature (C)", .marks = {{0.0, "40"}, {1.0, "60"}}});
    CHECK(small.pixels.size() == static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  }
}
