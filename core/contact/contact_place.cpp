#include "core/contact/contact_place.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace burrhole {
namespace {

constexpr double kFlattest = 20.0, kSharpest = 0.4;  // [voxel edges] radii of curvature of bone
constexpr double kFarAway = 100.0;                   // [voxel edges] centre of a flat face of bone
constexpr int kRounds = 3;                           // of a search; two are usual
constexpr int kCrossings = 4;                        // places on the way over an edge
// Places round the shell point from the deepest of which a search starts, as a cell may have more than one lowest place.
constexpr double kRingRadius = 0.6;  // [-] of the cell
constexpr std::pair<double, double> kRing[] = {{1.0, 0.0},  {0.5, 0.8660254},   {-0.5, 0.8660254},
                                               {-1.0, 0.0}, {-0.5, -0.8660254}, {0.5, -0.8660254}};
constexpr double kNear = 0.05;   // [voxel edges] a shorter way is not searched
constexpr double kLevel = 0.03;  // [-] slope along the way at which a place is its lowest

}  // namespace

PlaceFinder::PlaceFinder(const ToolSurface* surface, const RecordView& bone, const Pose& bone_from_tool) noexcept
    : surface_(surface),
      records_(bone),
      index_from_tool_(bone.bone_from_index.inverse() * Affine::from_pose(bone_from_tool)),
      axes_(glm::mat3_cast(bone_from_tool.rotation)),
      edge_(bone.bone_from_index.mean_edge()) {}

std::optional<ContactPlace> PlaceFinder::sample(const Vec3& at) const noexcept {
  const auto found = records_.at(index_from_tool_ * at);
  if (!found || found->normal == Vec3(0.0)) return std::nullopt;
  return ContactPlace{at, found->normal, found->distance * edge_, found->bend / edge_};
}

std::optional<ContactPlace> PlaceFinder::settle(const ContactPlace& from) const noexcept {
  const double radius = 1.0 / std::clamp(from.bend, 1.0 / (kFlattest * edge_), 1.0 / (kSharpest * edge_));
  const Vec3 centre = from.at - (from.gap + radius) * in_tool(from.normal);
  const auto at = surface_->nearest(centre);
  if (!at) return std::nullopt;
  const Vec3 way = *at - centre;
  const double length = glm::length(way);
  if (!(length > 0.0)) return std::nullopt;
  return ContactPlace{*at, axes_ * (way / length), length - radius, from.bend};
}

ContactPlace PlaceFinder::between(const ContactPlace& start, const ContactPlace& end) const noexcept {
  ContactPlace a = start, b = end, best = start.gap < end.gap ? start : end;
  for (int n = 0; n < kCrossings; ++n) {
    const Vec3 way = b.at - a.at;
    const double length = glm::length(way);
    if (length < kNear * edge_) break;
    const Vec3 along = way / length, na = in_tool(a.normal), nb = in_tool(b.normal);
    const double slope_a = glm::dot(na, along), slope_b = glm::dot(nb, along);
    if (!(slope_a < 0.0 && slope_b > 0.0)) break;
    // Odd rounds take the slopes' zero, which is that of a crest, even ones the crossing of the tangents, which is that of an edge.
    const double crossing = n % 2 == 0 ? (b.gap - a.gap - slope_b * length) / (slope_a - slope_b) : length * slope_a / (slope_a - slope_b);
    const double part = std::clamp(crossing, 0.05 * length, 0.95 * length);
    const auto at = surface_->nearest(a.at + part * along - (0.5 * length) * (na + nb));
    if (!at) break;
    const auto found = sample(*at);
    if (!found) break;
    if (found->gap < best.gap) best = *found;
    const double slope = glm::dot(in_tool(found->normal), along);
    const double predicted = std::max(a.gap + slope_a * part, b.gap + slope_b * (part - length));
    if (std::abs(slope) < kLevel || std::abs(found->gap - predicted) < 0.2 * kNear * edge_) break;
    (slope < 0.0 ? a : b) = *found;
  }
  return best;
}

std::optional<ContactPlace> PlaceFinder::deepest_of_ring(const Vec3& home, double radius) const noexcept {
  auto best = sample(home);
  if (!best) return std::nullopt;
  const Vec3 normal = in_tool(best->normal);
  const Vec3 side = std::abs(normal.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
  const Vec3 u = glm::normalize(glm::cross(normal, side)), v = glm::cross(normal, u);
  for (const auto& [cosine, sine] : kRing) {
    const auto at = surface_->nearest(home + (kRingRadius * radius) * (cosine * u + sine * v - normal));
    if (!at) continue;
    if (const auto found = sample(*at); found && found->gap < best->gap) best = found;
  }
  return best;
}

std::optional<ContactPlace> PlaceFinder::search(const Vec3& home, double radius) const noexcept {
  auto best = deepest_of_ring(home, radius);
  if (!best) return std::nullopt;
  for (int round = 0; round < kRounds; ++round) {
    const Vec3 normal = in_tool(best->normal);
    auto to = surface_->nearest(best->at - (kFarAway * edge_) * normal);
    if (!to) break;
    if (const double off = glm::length(*to - home); off > radius) {
      to = surface_->nearest(home + (*to - home) * (radius / off) - radius * normal);
      if (!to) break;
    }
    if (glm::length(*to - best->at) < kNear * edge_) break;
    const auto end = sample(*to);
    if (!end) break;
    const double before = best->gap;
    if (glm::dot(in_tool(end->normal), *to - best->at) > 0.0)
      best = between(*best, *end);
    else if (end->gap < best->gap)
      best = end;
    if (before - best->gap < 0.2 * kNear * edge_) break;
  }
  return best;
}

}  // namespace burrhole
