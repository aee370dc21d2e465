#include "app/render/overlay.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace burrhole {
namespace {

constexpr double kLetterWidth = 4.0;  ///< [grid]
constexpr double kAdvance = 5.7;      ///< [grid] from letter to letter
constexpr double kCapital = 6.0;      ///< [grid] height of capitals
constexpr double kBaseLine = 2.0;     ///< [grid] y of the base line

/// A letter: lines of points, each "xy" on a grid of 0..4 by 0..8, y up, base line at 2, small letters to 6, capitals to 8.
struct Letter {
  char sign;
  std::string_view lines;  ///< points separated by blanks, lines by commas
};

constexpr std::array kLetters{
    Letter{'0', "12 03 07 18 38 47 43 32 12"},
    Letter{'1', "17 28 22,12 32"},
    Letter{'2', "07 18 38 47 46 02 42"},
    Letter{'3', "07 18 38 47 46 35 15,35 44 43 32 12 03"},
    Letter{'4', "32 38 04 44"},
    Letter{'5', "48 08 05 35 44 43 32 12 03"},
    Letter{'6', "47 38 18 07 03 12 32 43 44 35 15 04"},
    Letter{'7', "08 48 12"},
    Letter{'8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"},
    Letter{'9', "03 12 32 43 47 38 18 07 06 15 35 46"},
    Letter{'.', "22 22"},
    Letter{',', "22 11"},
    Letter{':', "26 26,23 23"},
    Letter{';', "26 26,23 12"},
    Letter{'-', "15 35"},
    Letter{'+', "05 45,23 27"},
    Letter{'=', "06 46,04 44"},
    Letter{'/', "02 48"},
    Letter{'(', "38 27 23 32"},
    Letter{')', "18 27 23 12"},
    Letter{'%', "02 48,07 18 07,43 32 43"},
    Letter{'a', "16 36 45 42,44 14 03 12 32 43"},
    Letter{'b', "08 02,05 16 36 45 43 32 12 03"},
    Letter{'c', "45 36 16 05 03 12 32 43"},
    Letter{'d', "48 42,45 36 16 05 03 12 32 43"},
    Letter{'e', "04 44 45 36 16 05 03 12 32 43"},
    Letter{'f', "48 38 27 22,16 46"},
    Letter{'g', "46 41 30 10,45 36 16 05 03 12 32 43"},
    Letter{'h', "08 02,05 16 36 45 42"},
    Letter{'i', "16 26 22,12 32,28 28"},
    Letter{'j', "26 21 10 00,28 28"},
    Letter{'k', "08 02,36 04,14 42"},
    Letter{'l', "18 28 22,12 32"},
    Letter{'m', "02 06,05 16 25 22,25 36 45 42"},
    Letter{'n', "02 06,05 16 36 45 42"},
    Letter{'o', "16 05 03 12 32 43 45 36 16"},
    Letter{'p', "00 06,05 16 36 45 43 32 12 03"},
    Letter{'q', "40 46,45 36 16 05 03 12 32 43"},
    Letter{'r', "12 16,15 26 36 45"},
    Letter{'s', "45 36 16 05 14 34 43 32 12 03"},
    Letter{'t', "18 13 22 32 43,06 36"},
    Letter{'u', "06 03 12 32 43,46 42"},
    Letter{'v', "06 22 46"},
    Letter{'w', "06 12 25 32 46"},
    Letter{'x', "06 42,02 46"},
    Letter{'y', "06 22,46 22 10 00"},
    Letter{'z', "06 46 02 42"},
    Letter{'A', "02 28 42,14 34"},
    Letter{'B', "02 08 38 47 46 35 05,35 44 43 32 02"},
    Letter{'C', "47 38 18 07 03 12 32 43"},
    Letter{'D', "02 08 28 46 44 22 02"},
    Letter{'E', "48 08 02 42,05 35"},
    Letter{'F', "48 08 02,05 35"},
    Letter{'G', "47 38 18 07 03 12 32 43 45 25"},
    Letter{'H', "02 08,42 48,05 45"},
    Letter{'I', "18 38,28 22,12 32"},
    Letter{'J', "18 48,38 33 22 12 03"},
    Letter{'K', "08 02,48 05,15 42"},
    Letter{'L', "08 02 42"},
    Letter{'M', "02 08 25 48 42"},
    Letter{'N', "02 08 42 48"},
    Letter{'O', "12 03 07 18 38 47 43 32 12"},
    Letter{'P', "02 08 38 47 46 35 05"},
    Letter{'Q', "12 03 07 18 38 47 43 32 12,24 42"},
    Letter{'R', "02 08 38 47 46 35 05,25 42"},
    Letter{'S', "47 38 18 07 06 15 35 44 43 32 12 03"},
    Letter{'T', "08 48,28 22"},
    Letter{'U', "08 03 12 32 43 48"},
    Letter{'V', "08 22 48"},
    Letter{'W', "08 12 26 32 48"},
    Letter{'X', "08 42,02 48"},
    Letter{'Y', "08 25 48,25 22"},
    Letter{'Z', "08 48 02 42"},
};
constexpr std::string_view kFrame = "02 08 48 42 02";

std::string_view lines_of(char sign) {
  if (sign == ' ') return {};
  const auto* found = std::find_if(kLetters.begin(), kLetters.end(), [sign](const Letter& letter) { return letter.sign == sign; });
  return found == kLetters.end() ? kFrame : found->lines;
}

double distance_to(const Stroke& stroke, const PixelPoint& p) {
  const PixelPoint along = stroke.to - stroke.from;
  const double square = glm::dot(along, along);
  const double share = square > 0.0 ? std::clamp(glm::dot(p - stroke.from, along) / square, 0.0, 1.0) : 0.0;
  return glm::length(p - (stroke.from + share * along));
}

void blend(Rgba8& pixel, const Rgba8& color, double share) {
  const auto mixed = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(
        std::floor(static_cast<double>(from) + share * (static_cast<double>(to) - static_cast<double>(from)) + 0.5));
  };
  pixel = {mixed(pixel.r, color.r), mixed(pixel.g, color.g), mixed(pixel.b, color.b), pixel.a};
}

constexpr Rgba8 kWhite{250, 250, 250, 255}, kRim{18, 22, 28, 255};

std::string in_millimetres(double mm) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), mm, std::chars_format::general, 3);
  return std::string(text.data(), end.ptr) + " mm";
}

double line_width(double height) { return std::max(1.2, height / 8.0); }

}  // namespace

void paint(Image& image, const std::vector<Stroke>& strokes, double width, const Rgba8& color) {
  if (strokes.empty()) return;
  PixelPoint lo = strokes.front().from, hi = lo;
  for (const Stroke& stroke : strokes) {
    lo = glm::min(lo, glm::min(stroke.from, stroke.to));
    hi = glm::max(hi, glm::max(stroke.from, stroke.to));
  }
  const double reach = 0.5 * width + 1.0;
  const auto first = [reach](double at) { return static_cast<int>(std::clamp(std::floor(at - reach), 0.0, 65536.0)); };
  const auto last = [reach](double at, int size) {
    return static_cast<int>(std::clamp(std::ceil(at + reach), 0.0, static_cast<double>(size)));
  };
  for (int y = first(lo.y); y < last(hi.y, image.height); ++y)
    for (int x = first(lo.x); x < last(hi.x, image.width); ++x) {
      double nearest = reach;
      for (const Stroke& stroke : strokes) nearest = std::min(nearest, distance_to(stroke, {x + 0.5, y + 0.5}));
      const double share = std::clamp(0.5 * width - nearest + 0.5, 0.0, 1.0);
      if (share > 0.0)
        blend(image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)], color,
              share);
    }
}

void draw_rimmed(Image& image, const std::vector<Stroke>& strokes, double width, const Rgba8& color) {
  paint(image, strokes, width + std::max(2.0, 1.2 * width), kRim);
  paint(image, strokes, width, color);
}

std::vector<Stroke> write_text(std::string_view text, const PixelPoint& start, double height) {
  const double unit = height / kCapital;
  std::vector<Stroke> strokes;
  double left = start.x;
  for (const char sign : text) {
    const std::string_view lines = lines_of(sign);
    std::optional<PixelPoint> before;
    for (std::size_t n = 0; n + 1 < lines.size(); n += 3) {
      const PixelPoint at(left + unit * (lines[n] - '0'), start.y - unit * (lines[n + 1] - '0' - kBaseLine));
      if (before) strokes.push_back({*before, at});
      before = at;
      if (n + 2 < lines.size() && lines[n + 2] == ',') before.reset();
    }
    left += unit * kAdvance;
  }
  return strokes;
}

double text_width(std::string_view text, double height) noexcept {
  if (text.empty()) return 0.0;
  return height / kCapital * (kAdvance * static_cast<double>(text.size() - 1) + kLetterWidth);
}

void draw_text(Image& image, std::string_view text, const PixelPoint& start, double height) {
  draw_rimmed(image, write_text(text, start, height), line_width(height), kWhite);
}

ScaleBar fit_scale_bar(const CameraView& camera, int width, int height) {
  const double distance = glm::length(camera.target - camera.eye);
  const double pixels_per_metre = height / (2.0 * std::tan(0.5 * camera.vertical_fov) * distance);
  const double longest = 1e3 * 0.25 * width / pixels_per_metre;  // [mm]
  const double power = std::pow(10.0, std::floor(std::log10(longest)));
  const double mm = longest >= 5.0 * power ? 5.0 * power : (longest >= 2.0 * power ? 2.0 * power : power);
  return {1e-3 * mm, 1e-3 * mm * pixels_per_metre, in_millimetres(mm)};
}

void draw_scale_bar(Image& image, const ScaleBar& bar) {
  const double letter = std::clamp(image.height / 50.0, 7.0, 40.0);
  const double margin = 1.6 * letter, tick = 0.45 * letter;
  const PixelPoint left(margin, image.height - margin), right = left + PixelPoint(bar.pixels, 0.0);
  const PixelPoint down(0.0, tick);
  draw_rimmed(image, {{left, right}, {left - down, left + down}, {right - down, right + down}}, line_width(letter) * 1.3, kWhite);
  const double middle = 0.5 * (left.x + right.x) - 0.5 * text_width(bar.label, letter);
  draw_text(image, bar.label, {std::max(margin, middle), left.y - 0.9 * letter}, letter);
}

}  // namespace burrhole
