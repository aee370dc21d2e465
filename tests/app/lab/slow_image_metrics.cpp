#include "tests/app/lab/slow_image_metrics.h"

#include <array>
#include <functional>

namespace burrhole::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

const Rgba8& pixel(const Image& image, int x, int y) {
  x = std::clamp(x, 0, image.width - 1);
  y = std::clamp(y, 0, image.height - 1);
  return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}

double luma(const Rgba8& p) { return 0.299 * p.r + 0.587 * p.g + 0.114 * p.b; }

using Vec = std::array<double, 3>;

double linear(double code, bool gamma) {
  const double s = code / 255.0;
  if (!gamma) return s;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// CIE XYZ of linear sRGB over that of white.
Vec relative_xyz(const Vec& c) {
  constexpr double m[3][3] = {{0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};
  Vec out{};
  for (std::size_t r = 0; r < 3; ++r) {
    double sum = 0.0, white = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      sum += m[r][k] * c[k];
      white += m[r][k];
    }
    out[r] = sum / white;
  }
  return out;
}

Vec opponent(const Rgba8& p, bool gamma) {
  const Vec w = relative_xyz({linear(p.r, gamma), linear(p.g, gamma), linear(p.b, gamma)});
  return {116 * w[1] - 16, 500 * (w[0] - w[1]), 200 * (w[1] - w[2])};
}

/// The published inverse of the sRGB matrix; its last digit is worth 1e-7.
Vec clamped_rgb(const Vec& o) {
  const double y = (o[0] + 16) / 116;
  const double X = (y + o[1] / 500) * 0.95047, Y = y, Z = (y - o[2] / 200) * 1.0888300;
  const Vec rgb{3.2404542 * X - 1.5371385 * Y - 0.4985314 * Z, -0.9692660 * X + 1.8760108 * Y + 0.0415560 * Z,
                0.0556434 * X - 0.2040259 * Y + 1.0572252 * Z};
  return {std::clamp(rgb[0], 0.0, 1.0), std::clamp(rgb[1], 0.0, 1.0), std::clamp(rgb[2], 0.0, 1.0)};
}

Vec lab(const Vec& rgb, bool hunt) {
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const Vec w = relative_xyz(rgb);
  const double l = 116 * f(w[1]) - 16, fade = hunt ? 0.01 * l : 1.0;
  return {l, fade * 500 * (f(w[0]) - f(w[1])), fade * 200 * (f(w[1]) - f(w[2]))};
}

double hyab(const Vec& a, const Vec& b) {
  return std::abs(a[0] - b[0]) + std::sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/// Sum over a square of (2 radius + 1)^2 pixels round (x, y).
Vec weighed(const Image& image, int x, int y, int radius, bool gamma, const std::function<Vec(double, double)>& weight) {
  Vec sum{}, whole{};
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const Vec w = weight(dx, dy), o = opponent(pixel(image, x + dx, y + dy), gamma);
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += w[c] * o[c];
        whole[c] += w[c];
      }
    }
  return {sum[0] / whole[0], sum[1] / whole[1], sum[2] / whole[2]};
}

Vec seen(const Image& image, int x, int y, double ppd, bool gamma, bool hunt) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
  const Vec o = weighed(image, x, y, radius, gamma, [&](double dx, double dy) {
    const double z = (dx * dx + dy * dy) / (ppd * ppd);
    const auto bell = [&](double a, double b) { return a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * z / b); };
    return Vec{bell(1, 0.0047), bell(1, 0.0053), bell(34.1, 0.04) + bell(13.5, 0.025)};
  });
  return lab(clamped_rgb(o), hunt);
}

/// Length of the vector of responses of a filter along x and along y.
double feature(const Image& image, int x, int y, double ppd, bool points, bool gamma) {
  const double sigma = 0.5 * 0.082 * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  double response[2] = {};
  for (int axis = 0; axis < 2; ++axis) {
    double up = 0, down = 0, risen = 0, fallen = 0;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const double t = axis == 0 ? dx : dy;
        const double w = (points ? t * t / (sigma * sigma) - 1 : -t) * std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
        const double light = (opponent(pixel(image, x + dx, y + dy), gamma)[0] + 16) / 116;
        (w > 0 ? up : down) += w;
        (w > 0 ? risen : fallen) += w * light;
      }
    response[axis] = risen / up - fallen / down;
  }
  return std::sqrt(response[0] * response[0] + response[1] * response[1]);
}

}  // namespace

double slow_ssim(const Image& a, const Image& b, MetricSabotage sabotage) {
  const double sigma = sabotage == MetricSabotage::wide_window ? 2.0 : 1.5;
  const double c1 = 6.5025, c2 = 58.5225;
  double total = 0;
  int count = 0;
  for (int y = 5; y + 5 < a.height; ++y)
    for (int x = 5; x + 5 < a.width; ++x) {
      double whole = 0, ma = 0, mb = 0;
      const auto weight = [&](int dx, int dy) { return std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)); };
      for (int dy = -5; dy <= 5; ++dy)
        for (int dx = -5; dx <= 5; ++dx) {
          whole += weight(dx, dy);
          ma += weight(dx, dy) * luma(pixel(a, x + dx, y + dy));
          mb += weight(dx, dy) * luma(pixel(b, x + dx, y + dy));
        }
      ma /= whole;
      mb /= whole;
      double va = 0, vb = 0, cov = 0;
      for (int dy = -5; dy <= 5; ++dy)
        for (int dx = -5; dx <= 5; ++dx) {
          const double da = luma(pixel(a, x + dx, y + dy)) - ma, db = luma(pixel(b, x + dx, y + dy)) - mb;
          va += weight(dx, dy) / whole * da * da;
          vb += weight(dx, dy) / whole * db * db;
          cov += weight(dx, dy) / whole * da * db;
        }
      const double light = (2 * ma * mb + c1) / (ma * ma + mb * mb + c1);
      const double contrast_structure = (2 * cov + c2) / (va + vb + c2);
      total += light * contrast_structure;
      ++count;
    }
  return total / count;
}

double slow_flip(const Image& a, const Image& b, double ppd, MetricSabotage sabotage) {
  const bool gamma = sabotage != MetricSabotage::no_gamma, hunt = sabotage != MetricSabotage::no_hunt;
  const double top = std::pow(hyab(lab({0, 1, 0}, hunt), lab({0, 0, 1}, hunt)), 0.7);
  double total = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const double d = std::pow(hyab(seen(a, x, y, ppd, gamma, hunt), seen(b, x, y, ppd, gamma, hunt)), 0.7);
      const double colour = d < 0.4 * top ? 0.95 / (0.4 * top) * d : 0.95 + 0.05 * (d - 0.4 * top) / (0.6 * top);
      double change = 0;
      for (const bool points : {false, true})
        change = std::max(change, std::abs(feature(a, x, y, ppd, points, gamma) - feature(b, x, y, ppd, points, gamma)));
      if (sabotage == MetricSabotage::no_features) change = 0;
      total += std::pow(colour, 1 - std::sqrt(change / std::sqrt(2.0)));
    }
  return total / (a.width * a.height);
}

}  // namespace burrhole::test
