#include "app/view/quality.h"

#include <fmt/format.h>

#include <array>

#include "core/base/assert.h"

namespace burrhole {
namespace {

#include "app/view/quality_front.inc"

}  // namespace

std::span<const QualityPoint> shipped_front(bool translucent) {
  return translucent ? std::span<const QualityPoint>(kTranslucentFront) : std::span<const QualityPoint>(kSurfaceFront);
}

QualityChoice choose_quality(std::span<const QualityPoint> front, double first, double budget) {
  BH_ASSERT(!front.empty());
  QualityChoice out{front.front().quality, first * front.front().cost, first * front.front().cost <= budget};
  double best = front.front().psnr_db;
  for (const QualityPoint& point : front)
    if (first * point.cost <= budget && point.psnr_db > best) {
      out = {point.quality, first * point.cost, true};
      best = point.psnr_db;
    }
  return out;
}

std::string quality_text(const DrawingQuality& quality, bool translucent) {
  std::string out = fmt::format("step {:g} voxel", quality.step_voxels);
  if (!translucent) out += fmt::format(", {} bisections, {}", quality.bisections, quality.finish ? "finish" : "no finish");
  return out + fmt::format(", {0} x {0} rays a pixel, resolution {1:g}", quality.supersample, quality.resolution);
}

}  // namespace burrhole
