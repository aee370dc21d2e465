#include "core/tool/erosion_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace burrhole {
namespace {

/// Bounding box of what cuts in the layer at height z; nothing if the layer does not cut.
std::optional<Bounds> cutting_bounds(const ToolSpec& spec, double z) noexcept {
  std::optional<Bounds> all;
  for (const RegionSpec& region : spec.regions) {
    Bounds box = region.solid.bounds();
    if (region.erosion.base <= 0.0 || z < box.lo.z || z > box.hi.z) continue;
    if (region.solid.revolves()) {
      const double r = region.solid.radius(z);
      box = {Vec3(-r, -r, z), Vec3(r, r, z)};
    }
    all = all ? Bounds{glm::min(all->lo, box.lo), glm::max(all->hi, box.hi)} : box;
  }
  return all;
}

double cutting_height(const ToolSpec& spec) noexcept {
  double top = 0.0;
  for (const RegionSpec& region : spec.regions)
    if (region.erosion.base > 0.0) top = std::max(top, region.solid.z_high);
  return top;
}

/// Calls f(p, factor) for each cutting cell, ordered k, j, i with i fastest, until f returns false.
template <class F>
void for_each_cell(const ToolSpec& spec, double pitch, F&& f) {
  const auto layers = static_cast<long long>(std::ceil(cutting_height(spec) / pitch));
  const auto below = [&](double x) { return static_cast<long long>(std::floor(x / pitch)); };
  const auto above = [&](double x) { return static_cast<long long>(std::ceil(x / pitch)); };
  for (long long k = 0; k < layers; ++k) {
    const double z = (static_cast<double>(k) + 0.5) * pitch;
    const auto box = cutting_bounds(spec, z);
    if (!box) continue;
    for (long long j = below(box->lo.y); j < above(box->hi.y); ++j)
      for (long long i = below(box->lo.x); i < above(box->hi.x); ++i) {
        const Vec3 p((static_cast<double>(i) + 0.5) * pitch, (static_cast<double>(j) + 0.5) * pitch, z);
        const double factor = erosion_factor_at(spec, p);
        if (factor > 0.0 && !f(p, factor)) return;
      }
  }
}

Error too_many(double pitch) {
  return {
      ErrorCode::out_of_range,
      fmt::format("an erosion pitch of {:g} mm makes more than {} erosion points: take a coarser pitch", pitch * 1e3, kMaxErosionPoints),
      {}};
}

}  // namespace

double erosion_factor_at(const ToolSpec& spec, const Vec3& p) noexcept {
  const auto owner = spec.region_at(p);
  if (!owner) return 0.0;
  const RegionSpec& region = spec.regions[*owner];
  const ErosionRule& law = region.erosion;
  if (law.base <= 0.0) return 0.0;
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  const double radial = law.radial(r, region.solid.largest_radius());
  if (!law.needs_depth()) return law.base * radial * law.interior;  // every face has the interior's factor: no distance needed
  const NearestFace near = find_nearest_face(spec.solids(), spec.outline, p);
  return law.base * radial * (near.distance < law.skin ? law.of_face(near.face) : law.interior);
}

Result<ErosionPoints> make_erosion_points(const ToolSpec& spec, double pitch) {
  if (!std::isfinite(pitch) || pitch <= 0.0)
    return Error{ErrorCode::out_of_range, fmt::format("erosion pitch = {:g} mm must be > 0", pitch * 1e3), {}};
  double volume = 0.0;  // of the cutting regions; overlaps count twice
  for (const RegionSpec& region : spec.regions) volume += region.erosion.base > 0.0 ? region.solid.volume() : 0.0;
  // An early exit: overlaps cannot explain ten times the limit. It bounds the loop and its indices; the exact count below decides the rest.
  if (volume / (pitch * pitch * pitch) > 10.0 * static_cast<double>(kMaxErosionPoints)) return too_many(pitch);
  std::size_t count = 0;
  for_each_cell(spec, pitch, [&](const Vec3&, double) { return ++count <= kMaxErosionPoints; });
  if (count > kMaxErosionPoints) return too_many(pitch);
  ErosionPoints points;
  points.pitch = pitch;
  points.positions.reserve(count);
  points.factors.reserve(count);
  for_each_cell(spec, pitch, [&](const Vec3& p, double factor) {
    points.positions.push_back(p);
    points.factors.push_back(static_cast<float>(factor));
    return true;
  });
  return points;
}

}  // namespace burrhole
