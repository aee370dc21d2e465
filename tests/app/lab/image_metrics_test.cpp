// The image metrics against closed forms, against published properties and against a slow plain twin.
#include "app/lab/image_metrics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "tests/app/lab/slow_image_metrics.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

Image picture(int width, int height, const std::function<Rgba8(int, int)>& at) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.pixels.push_back(at(x, y));
  return image;
}

Image plain(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return picture(32, 24, [&](int, int) { return Rgba8{r, g, b, 255}; });
}

/// Soft blobs of colour with a hard edge through them: what a rendered picture is made of.
Image scene(int shift = 0) {
  return picture(32, 24, [&](int x, int y) {
    const double u = x + shift, v = y;
    const auto code = [](double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); };
    const double edge = u + 0.5 * v > 24 ? 70.0 : 0.0;
    return Rgba8{code(120 + 60 * std::sin(0.4 * u) + edge), code(110 + 50 * std::cos(0.3 * v + 0.2 * u) + edge),
                 code(90 + 80 * std::sin(0.25 * v)), 255};
  });
}

/// The same with noise of at most so many levels.
Image noisy(const Image& image, int levels) {
  Image out = image;
  for (std::size_t n = 0; n < out.pixels.size(); ++n) {
    const auto moved = [&](std::uint8_t value, std::uint64_t channel) {
      const double step = std::round((2.0 * uniform01(11, 3 * n + channel) - 1.0) * levels);
      return static_cast<std::uint8_t>(std::clamp(value + step, 0.0, 255.0));
    };
    Rgba8& p = out.pixels[n];
    p = {moved(p.r, 0), moved(p.g, 1), moved(p.b, 2), p.a};
  }
  return out;
}

}  // namespace

TEST_CASE("image metrics: a picture is no way off itself") {
  CHECK(std::isinf(psnr(scene(), scene())));
  CHECK(ssim(scene(), scene()) == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(flip(scene(), scene()) == 0.0);
  Image clear = scene();
  for (Rgba8& p : clear.pixels) p.a = 0;  // alpha is not looked at
  CHECK(flip(clear, scene()) == 0.0);
  CHECK(std::isinf(psnr(clear, scene())));
}

TEST_CASE("image metrics: none cares which of the two is the reference") {
  const Image a = scene(), b = noisy(scene(2), 20);
  CHECK(psnr(a, b) == psnr(b, a));
  CHECK(ssim(a, b) == doctest::Approx(ssim(b, a)).epsilon(1e-12));
  CHECK(flip(a, b) == doctest::Approx(flip(b, a)).epsilon(1e-12));
}

TEST_CASE("psnr: a shift of all channels by d levels is 20 log10(255 / d), of one channel a third of the power") {
  for (const int d : {1, 2, 16}) {
    const auto shade = static_cast<std::uint8_t>(100 + d);
    CHECK(psnr(plain(shade, shade, shade), plain(100, 100, 100)) == doctest::Approx(20.0 * std::log10(255.0 / d)).epsilon(1e-12));
    CHECK(psnr(plain(100, shade, 100), plain(100, 100, 100)) ==
          doctest::Approx(20.0 * std::log10(255.0 / d) + 10.0 * std::log10(3.0)).epsilon(1e-12));
  }
  CHECK(psnr(plain(255, 255, 255), plain(0, 0, 0)) == 0.0);
}

TEST_CASE("ssim: of two plain pictures it is the term of the light alone") {
  // Variances are 0, so the second factor is c2 / c2; rounding of E[x^2] - E[x]^2 is 1e-11 of 58.5.
  const double c1 = (0.01 * 255) * (0.01 * 255);
  for (const auto& [a, b] : {std::pair{100, 120}, std::pair{0, 255}, std::pair{250, 3}}) {
    const auto u = static_cast<std::uint8_t>(a), v = static_cast<std::uint8_t>(b);
    CHECK(ssim(plain(u, u, u), plain(v, v, v)) == doctest::Approx((2.0 * a * b + c1) / (a * a + b * b + c1)).epsilon(1e-9));
  }
}

TEST_CASE("ssim: a picture and its negative are unlike") {
  Image negative = scene();
  for (Rgba8& p : negative.pixels)
    p = {static_cast<std::uint8_t>(255 - p.r), static_cast<std::uint8_t>(255 - p.g), static_cast<std::uint8_t>(255 - p.b), p.a};
  CHECK(ssim(negative, scene()) < 0.0);
}

TEST_CASE("flip: black and white are as far apart as published, and plain pictures as their colours") {
  // L* 100 and 0: HyAB 100. Green and blue by CIE's formulas, with Hunt's fading: 203.3. So 0.95 + 0.05 (100^0.7 - 0.4 c) / (0.6 c), c = 203.3^0.7.
  const double c = std::pow(203.3, 0.7);
  const double expected = 0.95 + 0.05 * (std::pow(100.0, 0.7) - 0.4 * c) / (0.6 * c);
  CHECK(expected > 0.96);
  CHECK(flip(plain(0, 0, 0), plain(255, 255, 255)) == doctest::Approx(expected).epsilon(1e-3));  // 203.3 has four digits
  // The largest difference there is by definition.
  CHECK(flip(plain(0, 255, 0), plain(0, 0, 255)) == doctest::Approx(1.0).epsilon(1e-6));
}

TEST_CASE("flip: more difference is more, and what is too fine to be seen is less") {
  double last = 0.0;
  for (const int levels : {2, 6, 20, 60}) {
    const double here = flip(noisy(scene(), levels), scene());
    CHECK(here > 1.3 * last);
    last = here;
  }
  CHECK(last < 1.0);
  // Stripes of one pixel seen from ever further away: they blur to grey, which is what the reference is.
  const Image grey = plain(188, 188, 188);  // half the light of white
  const Image stripes = picture(32, 24, [](int x, int) { return x % 2 == 0 ? Rgba8{255, 255, 255, 255} : Rgba8{0, 0, 0, 255}; });
  CHECK(flip(stripes, grey, 120.0) < 0.6 * flip(stripes, grey, 30.0));
}

TEST_CASE("image metrics: the slow plain twins agree, and sabotaged ones do not") {
  const Image a = noisy(scene(1), 8), b = scene();
  CHECK(ssim(a, b) == doctest::Approx(slow_ssim(a, b)).epsilon(1e-9));
  CHECK(std::abs(ssim(a, b) - slow_ssim(a, b, MetricSabotage::wide_window)) > 1e-3);
  for (const double pixels_per_degree : {30.0, kPixelsPerDegree}) {
    const double here = flip(a, b, pixels_per_degree);
    CHECK(here == doctest::Approx(slow_flip(a, b, pixels_per_degree)).epsilon(1e-5));  // matrices of seven digits
    for (const MetricSabotage sabotage : {MetricSabotage::no_gamma, MetricSabotage::no_features, MetricSabotage::no_hunt})
      CHECK(std::abs(here - slow_flip(a, b, pixels_per_degree, sabotage)) > 1e-3);
  }
}
