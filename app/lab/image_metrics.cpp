#include "app/lab/image_metrics.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr int kLeastSide = 11;  // [pixels] the window of [Wang04]

/// One number per pixel, row by row.
struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// Odd length, its centre at offset 0.
using Kernel = std::vector<double>;

template <class F>
Kernel make_kernel(int radius, F&& value) {
  Kernel out;
  for (int x = -radius; x <= radius; ++x) out.push_back(value(static_cast<double>(x)));
  return out;
}

double sum_of(const Kernel& kernel) {
  double sum = 0.0;
  for (const double value : kernel) sum += value;
  return sum;
}

Kernel normalised(Kernel kernel) {
  const double sum = sum_of(kernel);
  for (double& value : kernel) value /= sum;
  return kernel;
}

/// Filtered along x by one kernel, then along y by the other; constant beyond the edges.
Plane filtered(const Plane& in, const Kernel& along_x, const Kernel& along_y) {
  const auto pass = [](const Plane& from, const Kernel& kernel, bool x_axis) {
    const int radius = static_cast<int>(kernel.size()) / 2, last = (x_axis ? from.width : from.height) - 1;
    Plane to(from.width, from.height);
    for (int y = 0; y < from.height; ++y)
      for (int x = 0; x < from.width; ++x) {
        double sum = 0.0;
        for (int k = -radius; k <= radius; ++k) {
          const int place = std::clamp((x_axis ? x : y) + k, 0, last);
          sum += kernel[static_cast<std::size_t>(k + radius)] * from.values[x_axis ? from.at(place, y) : from.at(x, place)];
        }
        to.values[to.at(x, y)] = sum;
      }
    return to;
  };
  return pass(pass(in, along_x, true), along_y, false);
}

template <class F>
Plane plane_of(const Image& image, F&& value) {
  Plane out(image.width, image.height);
  for (std::size_t n = 0; n < out.values.size(); ++n) out.values[n] = value(image.pixels[n]);
  return out;
}

void check(const Image& image, const Image& reference) {
  BH_ASSERT(image.width == reference.width && image.height == reference.height && image.pixels.size() == reference.pixels.size());
  BH_ASSERT(image.width >= kLeastSide && image.height >= kLeastSide);
}

// ---- FLIP: colours [Andersson20] section 4.1 ----

using Planes = std::array<Plane, 3>;

double linear_of(std::uint8_t code) {
  const double s = code / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// Linear sRGB to CIE XYZ (IEC 61966-2-1), columns red, green, blue; white is (1, 1, 1) through it.
const Mat3 kXyzFromRgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375, 0.0721750, 0.9503041);

/// Relative to white, which becomes (1, 1, 1).
Vec3 white_relative(const Vec3& linear_rgb) { return (kXyzFromRgb * linear_rgb) / (kXyzFromRgb * Vec3(1.0)); }

/// Linearised CIELAB, in which filtering is linear in light.
Vec3 opponent_of(const Vec3& linear_rgb) {
  const Vec3 w = white_relative(linear_rgb);
  return {116.0 * w.y - 16.0, 500.0 * (w.x - w.y), 200.0 * (w.y - w.z)};
}

Vec3 linear_of(const Vec3& opponent) {
  const double y = (opponent.x + 16.0) / 116.0;
  const Vec3 w(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
  static const Mat3 rgb_from_xyz = glm::inverse(kXyzFromRgb);
  return glm::clamp(rgb_from_xyz * (w * (kXyzFromRgb * Vec3(1.0))), Vec3(0.0), Vec3(1.0));
}

/// CIELAB with chroma reduced for dark colours (Hunt effect).
Vec3 seen_colour(const Vec3& linear_rgb) {
  const auto f = [](double t) {
    constexpr double kKnee = 6.0 / 29.0;
    return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3.0 * kKnee * kKnee) + 4.0 / 29.0;
  };
  const Vec3 w = white_relative(linear_rgb);
  const double lightness = 116.0 * f(w.y) - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f(w.x) - f(w.y)), 0.01 * lightness * 200.0 * (f(w.y) - f(w.z))};
}

/// Separate differences of lightness and chroma: HyAB.
double distance(const Vec3& a, const Vec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// Compressed, then mapped to 0..1 so that small differences use most of the range.
double colour_error(const Vec3& a, const Vec3& b) {
  constexpr double kPower = 0.7, kKnee = 0.4, kShare = 0.95;
  static const double largest = std::pow(distance(seen_colour({0.0, 1.0, 0.0}), seen_colour({0.0, 0.0, 1.0})), kPower);
  const double d = std::pow(distance(a, b), kPower);
  if (d < kKnee * largest) return kShare * d / (kKnee * largest);
  return kShare + (1.0 - kShare) * (d - kKnee * largest) / (largest - kKnee * largest);
}

/// One part of a contrast sensitivity function as a spatial Gaussian: a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees.
struct Sensitivity {
  double a, b;
};
// Achromatic, red to green, blue to yellow: [Andersson20] table 1.
constexpr Sensitivity kLight{1.0, 0.0047}, kRedGreen{1.0, 0.0053}, kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

int sensitivity_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3.0 * std::sqrt(kBlueYellow[0].b / (2.0 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree));
}

/// Not normalised; the 2D kernel is its product with itself.
Kernel sensitivity_kernel(const Sensitivity& s, double pixels_per_degree) {
  return make_kernel(sensitivity_radius(pixels_per_degree), [&](double x) {
    const double r = std::numbers::pi * x / pixels_per_degree;
    return std::exp(-r * r / s.b);
  });
}

Plane filtered_by(const Plane& in, const Sensitivity& s, double pixels_per_degree) {
  const Kernel kernel = normalised(sensitivity_kernel(s, pixels_per_degree));
  return filtered(in, kernel, kernel);
}

/// The sum of two Gaussians is not separable, so each is applied separately and weighted by its integral.
Plane filtered_blue_yellow(const Plane& in, double pixels_per_degree) {
  Plane out(in.width, in.height);
  double whole = 0.0;
  for (const Sensitivity& s : kBlueYellow) {
    const double sum = sum_of(sensitivity_kernel(s, pixels_per_degree));
    const double weight = s.a * std::sqrt(std::numbers::pi / s.b) * sum * sum;
    const Plane part = filtered_by(in, s, pixels_per_degree);
    for (std::size_t n = 0; n < out.values.size(); ++n) out.values[n] += weight * part.values[n];
    whole += weight;
  }
  for (double& value : out.values) value /= whole;
  return out;
}

Planes opponent_planes(const Image& image) {
  Planes out{Plane(image.width, image.height), Plane(image.width, image.height), Plane(image.width, image.height)};
  for (std::size_t n = 0; n < image.pixels.size(); ++n) {
    const Rgba8& p = image.pixels[n];
    const Vec3 v = opponent_of({linear_of(p.r), linear_of(p.g), linear_of(p.b)});
    for (std::size_t c = 0; c < 3; ++c) out[c].values[n] = v[static_cast<glm::length_t>(c)];
  }
  return out;
}

/// Colours as perceived at the observer's distance.
std::vector<Vec3> seen_colours(const Planes& opponent, double pixels_per_degree) {
  const Planes seen{filtered_by(opponent[0], kLight, pixels_per_degree), filtered_by(opponent[1], kRedGreen, pixels_per_degree),
                    filtered_blue_yellow(opponent[2], pixels_per_degree)};
  std::vector<Vec3> out;
  for (std::size_t n = 0; n < seen[0].values.size(); ++n)
    out.push_back(seen_colour(linear_of(Vec3(seen[0].values[n], seen[1].values[n], seen[2].values[n]))));
  return out;
}

// ---- FLIP: edges and points [Andersson20] section 4.2 ----

/// Positive weights add to 1, negative ones to -1.
Kernel balanced(Kernel kernel) {
  double up = 0.0, down = 0.0;
  for (const double value : kernel) (value > 0.0 ? up : down) += value;
  for (double& value : kernel) value /= value > 0.0 ? up : -down;
  return kernel;
}

/// Length of the gradient, or of the second derivatives, of the lightness at each pixel.
Plane features(const Plane& light, double pixels_per_degree, bool points) {
  constexpr double kWidth = 0.082;  // [deg] of a feature
  const double sigma = 0.5 * kWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto bell = [&](double x) { return std::exp(-x * x / (2.0 * sigma * sigma)); };
  const Kernel smooth = normalised(make_kernel(radius, bell));
  const Kernel slope =
      balanced(make_kernel(radius, [&](double x) { return points ? (x * x / (sigma * sigma) - 1.0) * bell(x) : -x * bell(x); }));
  Plane along_x = filtered(light, slope, smooth);
  const Plane along_y = filtered(light, smooth, slope);
  for (std::size_t n = 0; n < along_x.values.size(); ++n) along_x.values[n] = std::hypot(along_x.values[n], along_y.values[n]);
  return along_x;
}

Plane light_of(const Planes& opponent) {
  Plane out = opponent[0];
  for (double& value : out.values) value = (value + 16.0) / 116.0;
  return out;
}

}  // namespace

double psnr(const Image& image, const Image& reference) {
  check(image, reference);
  double sum = 0.0;
  for (std::size_t n = 0; n < image.pixels.size(); ++n) {
    const Rgba8 &a = image.pixels[n], &b = reference.pixels[n];
    const Vec3 d(a.r - b.r, a.g - b.g, a.b - b.b);
    sum += glm::dot(d, d);
  }
  if (sum == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(image.pixels.size()) / sum);
}

double ssim(const Image& image, const Image& reference) {
  check(image, reference);
  constexpr int kRadius = kLeastSide / 2;
  constexpr double kSigma = 1.5, kC1 = (0.01 * 255.0) * (0.01 * 255.0), kC2 = (0.03 * 255.0) * (0.03 * 255.0);
  const Kernel window = normalised(make_kernel(kRadius, [](double x) { return std::exp(-x * x / (2.0 * kSigma * kSigma)); }));
  const auto luma = [](const Rgba8& p) { return 0.299 * p.r + 0.587 * p.g + 0.114 * p.b; };
  const Plane a = plane_of(image, luma), b = plane_of(reference, luma);
  const auto mean_of_product = [&](const Plane& u, const Plane& v) {
    Plane product = u;
    for (std::size_t n = 0; n < product.values.size(); ++n) product.values[n] *= v.values[n];
    return filtered(product, window, window);
  };
  const Plane mean_a = filtered(a, window, window), mean_b = filtered(b, window, window);
  const Plane aa = mean_of_product(a, a), bb = mean_of_product(b, b), ab = mean_of_product(a, b);
  double sum = 0.0;
  for (int y = kRadius; y < a.height - kRadius; ++y)
    for (int x = kRadius; x < a.width - kRadius; ++x) {
      const std::size_t n = a.at(x, y);
      const double ma = mean_a.values[n], mb = mean_b.values[n];
      const double variances = aa.values[n] - ma * ma + bb.values[n] - mb * mb, covariance = ab.values[n] - ma * mb;
      sum += (2.0 * ma * mb + kC1) * (2.0 * covariance + kC2) / ((ma * ma + mb * mb + kC1) * (variances + kC2));  // [Wang04]
    }
  return sum / (static_cast<double>(a.width - 2 * kRadius) * static_cast<double>(a.height - 2 * kRadius));
}

double flip(const Image& image, const Image& reference, double pixels_per_degree) {
  check(image, reference);
  const Planes a = opponent_planes(image), b = opponent_planes(reference);
  const std::vector<Vec3> seen_a = seen_colours(a, pixels_per_degree), seen_b = seen_colours(b, pixels_per_degree);
  const Plane light_a = light_of(a), light_b = light_of(b);
  const Plane edges_a = features(light_a, pixels_per_degree, false), edges_b = features(light_b, pixels_per_degree, false);
  const Plane points_a = features(light_a, pixels_per_degree, true), points_b = features(light_b, pixels_per_degree, true);
  double sum = 0.0;
  for (std::size_t n = 0; n < seen_a.size(); ++n) {
    const double edge = std::abs(edges_a.values[n] - edges_b.values[n]), point = std::abs(points_a.values[n] - points_b.values[n]);
    const double feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2);
    sum += std::pow(colour_error(seen_a[n], seen_b[n]), 1.0 - feature);
  }
  return sum / static_cast<double>(seen_a.size());
}

}  // namespace burrhole
