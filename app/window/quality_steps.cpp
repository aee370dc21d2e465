#include "app/window/quality_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

/// @returns the rays of a picture relative to one a pixel.
double rays_of(const DrawingQuality& q) {
  const double side = q.supersample * q.resolution;
  return side * side;
}

}  // namespace

std::optional<double> known_psnr(std::span<const QualityPoint> front, const DrawingQuality& quality) {
  const auto found = std::ranges::find(front, quality, &QualityPoint::quality);
  return found == front.end() ? std::nullopt : std::optional(found->psnr_db);
}

DrawingQuality next_quality(std::span<const QualityPoint> front, const DrawingQuality& quality, bool finer) {
  if (front.empty()) return quality;
  const auto found = std::ranges::find(front, quality, &QualityPoint::quality);
  if (found != front.end()) {
    if (finer) return std::next(found) == front.end() ? quality : std::next(found)->quality;
    return found == front.begin() ? quality : std::prev(found)->quality;
  }
  const double rays = rays_of(quality);
  if (finer) {
    const auto more = std::ranges::find_if(front, [&](const QualityPoint& p) { return rays_of(p.quality) > rays; });
    return more == front.end() ? front.back().quality : more->quality;
  }
  DrawingQuality fewer = front.front().quality;
  for (const QualityPoint& p : front)
    if (rays_of(p.quality) < rays) fewer = p.quality;
  return fewer;
}

std::string lights_text(const std::optional<LightsChange>& change) {
  if (!change) return "shadows, highlights: time and difference are measured when one is changed at rest";
  const std::string differs = change->psnr ? fmt::format("{:.1f} dB to the picture before", *change->psnr) : "no pixel differs";
  return fmt::format("shadows, highlights: the last change took {:+.0f} ms; {}, measured here", change->more_ms, differs);
}

std::optional<double> psnr_of(const Image& image, const Image& reference) {
  if (image.width != reference.width || image.height != reference.height || image.pixels.empty()) return std::nullopt;
  double sum = 0.0;
  for (std::size_t n = 0; n < image.pixels.size(); ++n) {
    const Rgba8 &a = image.pixels[n], &b = reference.pixels[n];
    const Vec3 d(a.r - b.r, a.g - b.g, a.b - b.b);
    sum += glm::dot(d, d);
  }
  if (sum == 0.0) return std::nullopt;
  return 10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(image.pixels.size()) / sum);
}

}  // namespace burrhole
