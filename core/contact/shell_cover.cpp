#include "core/contact/shell_cover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace burrhole {
namespace {

constexpr double kCells = 8.0;  // along the longest edge of the box round the points

}  // namespace

ShellCover::ShellCover(const std::vector<Vec3>& points) {
  if (points.empty()) return;
  Vec3 lo = points.front(), hi = lo;
  for (const Vec3& p : points) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const double cell = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, 1e-6}) / kCells;
  struct Bounds {
    Vec3 lo, hi;
  };
  const auto cell_of = [&](const Vec3& p) {
    const Vec3 at = glm::floor((p - lo) / cell);
    return std::tuple(at.x, at.y, at.z);
  };
  std::map<std::tuple<double, double, double>, Bounds> cells;
  for (const Vec3& p : points) {
    const auto [entry, added] = cells.try_emplace(cell_of(p), Bounds{p, p});
    if (added) continue;
    entry->second.lo = glm::min(entry->second.lo, p);
    entry->second.hi = glm::max(entry->second.hi, p);
  }
  for (const auto& [place, bounds] : cells) spheres_.push_back({0.5 * (bounds.lo + bounds.hi), 0.5 * glm::length(bounds.hi - bounds.lo)});
}

double ShellCover::clearance(const CoarseDistance& bone, const Affine& index_from_tool) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const Sphere& sphere : spheres_) least = std::min(least, bone.at(index_from_tool * sphere.centre) - sphere.radius);
  return least;
}

bool ShellCover::reaches_unread(const ContactView& view, const CoarseDistance& bone, const Pose& world_from_tool) const noexcept {
  const Affine index_from_tool = view.index_from_world() * Affine::from_pose(world_from_tool);
  return std::ranges::any_of(spheres_, [&](const Sphere& sphere) {
    const Vec3 centre = index_from_tool * sphere.centre;
    if (bone.at(centre) > sphere.radius) return false;
    // The box round the sphere: an index axis sees it by the length of that row of the map.
    Vec3 half(0.0);
    for (std::size_t c = 0; c < 3; ++c) half += index_from_tool.linear[c] * index_from_tool.linear[c];
    half = glm::sqrt(half) * sphere.radius;
    if (!holds_index(centre - half) || !holds_index(centre + half)) return true;
    return !view.knows(voxel_of(centre - half)) || !view.knows(voxel_of(centre + half));
  });
}

}  // namespace burrhole
