#include "core/tool/finest_feature.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

constexpr double kTouching = 1e-6;  // [m] between regions that lie on each other
constexpr int kSamples = 5;         // across a lower face, along each axis

bool cuts(const RegionSpec& region) noexcept { return region.erosion.base > 0.0; }
bool cuts(const RegionSpec& region, Face face) noexcept { return cuts(region) && region.erosion.of_face(face) > 0.0; }

/// Whether part of a region's lower face cuts and no other region lies below it.
bool has_free_end(const ToolSpec& spec, const RegionSpec& region) {
  if (!cuts(region, Face::bottom)) return false;
  const Bounds box = region.solid.bounds();
  for (int i = 0; i < kSamples; ++i)
    for (int j = 0; j < kSamples; ++j) {
      const auto at = [](double lo, double hi, int n) { return lo + (hi - lo) * (n + 0.5) / kSamples; };
      const Vec3 p(at(box.lo.x, box.hi.x, i), at(box.lo.y, box.hi.y, j), region.solid.z_low);
      if (region.solid.contains(p + Vec3(0.0, 0.0, kTouching)) && !spec.region_at(p - Vec3(0.0, 0.0, kTouching))) return true;
    }
  return false;
}

/// [m] along the shaft of the regions that cut without a gap, of which this is one.
double cutting_height(const ToolSpec& spec, const RegionSpec& region) {
  double low = region.solid.z_low, high = region.solid.z_high;
  for (std::size_t round = 0; round < spec.regions.size(); ++round)
    for (const RegionSpec& other : spec.regions) {
      if (!cuts(other) || other.solid.z_low > high + kTouching || other.solid.z_high < low - kTouching) continue;
      low = std::min(low, other.solid.z_low);
      high = std::max(high, other.solid.z_high);
    }
  return high - low;
}

/// [m] by which a solid of revolution is wider at its lower end than what lies under it; nothing where nothing does.
std::optional<double> step_width(const ToolSpec& spec, const RegionSpec& region) {
  if (!cuts(region, Face::bottom) || !region.solid.revolves()) return std::nullopt;
  for (const RegionSpec& below : spec.regions)
    if (below.solid.revolves() && std::abs(below.solid.z_high - region.solid.z_low) < kTouching) {
      const double width = region.solid.radius(region.solid.z_low) - below.solid.radius(below.solid.z_high);
      if (width > kTouching) return width;
    }
  return std::nullopt;
}

}  // namespace

std::optional<CuttingFeature> finest_cutting_feature(const ToolSpec& spec) {
  std::optional<CuttingFeature> out;
  for (const RegionSpec& region : spec.regions) {
    if (!cuts(region)) continue;
    const Solid& s = region.solid;
    const auto add = [&](double thickness, const char* kind) {
      if (thickness > 0.0 && (!out || thickness < out->thickness)) out = CuttingFeature{thickness, region.name, kind};
    };
    const bool end = has_free_end(spec, region);
    if (s.kind == SolidKind::box) {
      if (end || (cuts(region, Face::minus_x) && cuts(region, Face::plus_x))) add(2.0 * s.half_size.x, "width");
      if (end || (cuts(region, Face::minus_y) && cuts(region, Face::plus_y))) add(2.0 * s.half_size.y, "depth");
    } else if (s.bored()) {
      if (end || (cuts(region, Face::side) && cuts(region, Face::inner)))
        add(std::max(s.low_radius - s.low_bore, s.high_radius - s.high_bore), "wall");
    } else if (end || cuts(region, Face::side)) {
      add(2.0 * s.largest_radius(), "diameter");
    }
    if (const auto width = step_width(spec, region)) add(*width, "step");
    add(cutting_height(spec, region), "height");
    if (region.erosion.interior == 0.0) add(region.erosion.skin, "skin");
  }
  return out;
}

}  // namespace burrhole
