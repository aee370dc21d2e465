#include "app/render/marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>

#include "app/render/overlay.h"
#include "app/render/tip_slices_picture.h"
#include "app/view/camera.h"
#include "core/base/color_ramp.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr Rgba8 kNear{250, 250, 250, 255}, kFar{150, 160, 172, 255}, kBox{255, 214, 120, 255};
constexpr double kLeastNote = 7.0;  // [pixels] height of letters that can be read
constexpr double kShortest = 0.30;  // [-] of a half axis that has a letter
// [letters] least distances of a letter's middle from that of another, from the axes of others and from its own; and its own from the mark.
constexpr double kLetterRoom = 2.0, kAxisRoom = 0.75, kOwnRoom = 0.8, kFarthest = 4.1;
constexpr double kBehind = -0.05;  // [-] depth of a direction that is drawn as far
constexpr std::array kSides{"R-L", "A-P", "I-S"};

double letter_height(const Image& image) { return std::clamp(image.height / 50.0, 7.0, 40.0); }

/// Lines of whole words of at most that width [pixels]; a longer word has a line of its own.
std::vector<std::string> wrapped(const std::string& text, double letter, double width) {
  std::vector<std::string> out(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = out.back().empty() ? word : out.back() + " " + word;
    if (out.back().empty() || text_width(longer, letter) <= width)
      out.back() = longer;
    else
      out.push_back(word);
  }
  return out;
}

/// Where a camera shows a point [pixels]; nothing behind it.
class Projection {
 public:
  Projection(const CameraRays& rays, const Image& image) : rays_(rays), size_(image.width, image.height) {}
  [[nodiscard]] std::optional<PixelPoint> at(const Vec3& p) const {
    const Vec3 way = p - rays_.eye;
    const double depth = glm::dot(way, rays_.axis);
    if (depth < kNearestPlane) return std::nullopt;
    const Vec3 aside = way / depth - rays_.forward;
    const double x = glm::dot(aside, rays_.right) / glm::dot(rays_.right, rays_.right);
    const double y = glm::dot(aside, rays_.up) / glm::dot(rays_.up, rays_.up);
    return 0.5 * PixelPoint(1.0 + x, 1.0 - y) * size_;
  }

 private:
  CameraRays rays_;
  PixelPoint size_;
};

double distance_to_axis(const glm::dvec2& p, const glm::dvec2& end) {
  const double squared = glm::dot(end, end);
  return glm::length(p - (squared > 0.0 ? std::clamp(glm::dot(p, end) / squared, 0.0, 1.0) : 0.0) * end);
}

/// @returns by how much a place of a letter is too near to other letters and to the axes [letters]; 0 for a free one.
double crowded(const std::array<PatientDirection, 6>& directions, std::size_t own, const glm::dvec2& at,
               const std::array<std::optional<glm::dvec2>, 6>& others) {
  double out = 0.0;
  for (std::size_t n = 0; n < directions.size(); ++n) {
    const double room = n == own ? kOwnRoom : kAxisRoom;
    out += std::max(0.0, room - distance_to_axis(at, kMarkRadius * directions[n].end));
    if (others[n]) out += std::max(0.0, kLetterRoom - glm::length(*others[n] - at));
  }
  return out;
}

/// @returns the best place round the end of a direction.
glm::dvec2 place_letter(const std::array<PatientDirection, 6>& directions, std::size_t own,
                        const std::array<std::optional<glm::dvec2>, 6>& others) {
  constexpr std::array kAway{0.95, 1.2, 1.5, 1.9, 2.4};                         // [letters] from the end
  constexpr double kTurn = 0.35, kPerTurn = 0.8, kCrowded = 20.0, kMost = 6.0;  // [rad], and costs
  const glm::dvec2 end = kMarkRadius * directions[own].end;
  const double outward = std::atan2(end.y, end.x);
  glm::dvec2 best = end;
  double least = INFINITY;
  for (const double away : kAway)
    for (double turn = -kMost * kTurn; turn < (kMost + 0.5) * kTurn; turn += kTurn) {
      const glm::dvec2 at = end + away * glm::dvec2(std::cos(outward + turn), std::sin(outward + turn));
      if (std::max(std::abs(at.x), std::abs(at.y)) > kFarthest) continue;
      const double cost = away + kPerTurn * std::abs(turn) + kCrowded * crowded(directions, own, at, others);
      if (cost < least) least = cost, best = at;
    }
  return best;
}

}  // namespace

std::array<PatientDirection, 6> patient_directions(const CameraView& camera, const Pose& world_from_patient) {
  const auto rays = make_camera_rays(camera, 1.0);
  std::array<PatientDirection, 6> out{};
  if (!rays) return out;
  const Vec3 right = glm::normalize(rays->right), up = glm::normalize(rays->up);
  constexpr std::array<char, 6> kLetters{'L', 'R', 'P', 'A', 'S', 'I'};
  for (std::size_t n = 0; n < out.size(); ++n) {
    Vec3 axis(0.0);
    axis[n / 2] = n % 2 == 0 ? 1.0 : -1.0;
    const Vec3 way = world_from_patient.rotate(axis);
    out[n] = {kLetters[n], {glm::dot(way, right), glm::dot(way, up)}, -glm::dot(way, rays->axis)};
  }
  std::ranges::stable_sort(out, {}, &PatientDirection::depth);
  return out;
}

std::array<std::optional<glm::dvec2>, 6> place_letters(const std::array<PatientDirection, 6>& directions) {
  std::array<std::size_t, 6> order{0, 1, 2, 3, 4, 5};
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t n) { return glm::length(directions[n].end); });
  std::array<std::optional<glm::dvec2>, 6> out;
  for (const std::size_t n : order)
    if (glm::length(directions[n].end) >= kShortest) out[n] = place_letter(directions, n, out);
  return out;
}

void draw_orientation(Image& image, const CameraView& camera, const Pose& world_from_patient) {
  const double letter = letter_height(image), radius = kMarkRadius * letter, width = std::max(1.2, letter / 8.0);
  const PixelPoint middle(image.width - 1.6 * letter - radius - letter, image.height - 1.6 * letter - radius - letter);
  const std::array<PatientDirection, 6> directions = patient_directions(camera, world_from_patient);
  const auto places = place_letters(directions);
  const auto pixel = [&](const glm::dvec2& from_middle) { return middle + letter * PixelPoint(from_middle.x, -from_middle.y); };
  for (const PatientDirection& one : directions)
    draw_rimmed(image, {{middle, pixel(kMarkRadius * one.end)}}, one.depth > kBehind ? 1.5 * width : width,
                one.depth > kBehind ? kNear : kFar);
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!places[n]) continue;
    const std::string name(1, directions[n].letter);
    const PixelPoint start = pixel(*places[n]) + PixelPoint(-0.5 * text_width(name, letter), 0.5 * letter);
    draw_rimmed(image, write_text(name, start, letter), width, directions[n].depth > kBehind ? kNear : kFar);
  }
}

void draw_note(Image& image, const std::string& text) {
  const double usual = std::max(kLeastNote, 0.8 * letter_height(image));
  const double width = std::max(1.2, usual / 8.0);
  // Between scale bar and directions if it fits there, a little smaller if needed.
  const double fitting = usual * std::min(1.0, 0.42 * image.width / std::max(1.0, text_width(text, usual)));
  if (fitting >= std::max(kLeastNote, 0.75 * usual)) {
    const PixelPoint start(0.53 * image.width - 0.5 * text_width(text, fitting), image.height - 1.6 * letter_height(image));
    return draw_rimmed(image, write_text(text, start, fitting), width, kNear);
  }
  // In lines in the upper left corner, beside the inset.
  double line = 2.0 * usual;
  for (const std::string& words : wrapped(text, usual, 0.7 * image.width - 2.0 * usual)) {
    draw_rimmed(image, write_text(words, {usual, line}, usual), width, kNear);
    line += 1.7 * usual;
  }
}

void draw_color_bar(Image& image, const ColorBar& bar) {
  const double letter = letter_height(image), width = std::max(1.2, letter / 8.0);
  const double left = 1.6 * letter, right = left + 1.2 * letter, top = 0.3 * image.height, bottom = 0.7 * image.height;
  const auto height = [&](double share) { return bottom + share * (top - bottom); };
  draw_rimmed(
      image,
      {{{left, top}, {right, top}}, {{right, top}, {right, bottom}}, {{right, bottom}, {left, bottom}}, {{left, bottom}, {left, top}}},
      width, kNear);
  for (int y = static_cast<int>(std::ceil(top)); y < static_cast<int>(bottom); ++y) {
    const RampColor color = ramp_color((bottom - y - 0.5) / (bottom - top));
    for (int x = static_cast<int>(std::ceil(left)); x < std::min(image.width, static_cast<int>(right)); ++x)
      image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] = {color.r, color.g,
                                                                                                                         color.b, 255};
  }
  for (const auto& [share, text] : bar.marks) {
    draw_rimmed(image, {{{right, height(share)}, {right + 0.4 * letter, height(share)}}}, width, kNear);
    draw_rimmed(image, write_text(text, {right + 0.9 * letter, height(share) + 0.5 * letter}, letter), width, kNear);
  }
  double line = top - letter;
  const std::vector<std::string> lines = wrapped(bar.title, letter, 0.25 * image.width);
  for (auto words = lines.rbegin(); words != lines.rend(); ++words) {
    draw_rimmed(image, write_text(*words, {left, line}, letter), width, kNear);
    line -= 1.7 * letter;
  }
}

void frame_into(Image& image, const Image& small) {
  const int gap = std::max(4, image.height / 60);
  const double left = image.width - small.width - gap, right = left + small.width, bottom = gap + small.height;
  copy_into(image, small, static_cast<int>(left), gap);
  const PixelPoint a(left, gap), b(right, gap), c(right, bottom), d(left, bottom);
  for (const Stroke& side : {Stroke{a, b}, Stroke{b, c}, Stroke{c, d}, Stroke{d, a}}) paint(image, {side}, 1.5, kFar);
}

void draw_box(Image& image, const CameraView& camera, const Bounds& box) {
  const auto rays = make_camera_rays(camera, static_cast<double>(image.width) / image.height);
  if (!rays) return;
  const Projection projection(*rays, image);
  const double letter = letter_height(image);
  const auto centre = projection.at(0.5 * (box.lo + box.hi));
  const std::vector<BoxEdge> edges = seen_edges(box, camera.eye);
  std::vector<Stroke> strokes;
  std::array<std::optional<PixelPoint>, 3> labels;  // the lowest edge of the outline along each axis
  for (const BoxEdge& edge : edges) {
    const auto from = projection.at(edge.from), to = projection.at(edge.to);
    if (!from || !to) continue;
    strokes.push_back({*from, *to});
    const PixelPoint middle = 0.5 * (*from + *to);
    auto& label = labels[edge.axis];
    const bool better = !label || (edge.axis == 2 ? middle.x < label->x : middle.y > label->y);
    if (edge.outline && better) label = middle;
  }
  draw_rimmed(image, strokes, std::max(1.2, letter / 10.0), kBox);
  for (std::size_t axis = 0; axis < labels.size(); ++axis) {
    if (!labels[axis] || !centre) continue;
    const std::string text = fmt::format("{} {:.1f} mm", kSides[axis], (box.hi[axis] - box.lo[axis]) / kMillimetre);
    const double wide = text_width(text, letter);
    const PixelPoint away = *labels[axis] - *centre;
    const double length = std::max(1.0, glm::length(away));
    PixelPoint middle = *labels[axis] + away / length * (letter + 0.5 * wide * std::abs(away.x) / length);
    middle = glm::clamp(middle, PixelPoint(0.5 * wide + letter, 2.0 * letter),
                        PixelPoint(image.width - 0.5 * wide - letter, image.height - 2.0 * letter));
    draw_rimmed(image, write_text(text, middle + PixelPoint(-0.5 * wide, 0.5 * letter), letter), std::max(1.2, letter / 8.0), kBox);
  }
}

}  // namespace burrhole
