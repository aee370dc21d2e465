#include "core/contact/hollow_direction.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

// [voxel edges] of gap, beyond the touching point's, within which a point counts: all that a look tells (its look-ahead). With half of it the
// direction in a dent is off by twice as much.
constexpr double kNearly = 0.6;
constexpr double kReach = 8.0;  // [voxel edges] from the touching point: a wider patch may be of another place
constexpr double kAlike = 0.3;  // [-] cosine of 73 degrees off the mean: a wall beside a floor is another face
// [1/voxel edge] of outward bend by which a point counts half: a radius of 33 voxels; noise of normals is a quarter of it. Across an edge the
// patch would lie about the edge and not about the touch.
constexpr double kBulge = 0.03;
// [-] of the patch, by weight, that does not bulge: from where the mean counts, and where it alone does.
constexpr double kLeastShare = 0.8, kWholeShare = 0.95;
constexpr int kPasses = 3;  // the window of directions is about the mean, which is not known before
constexpr std::size_t kAsked = 2000;  // and up to twice as many: bounds the time

struct PatchSum {
  Vec3 normal{0.0};
  double all = 0.0, level = 0.0;  // weights: of all, and of those that do not bulge
};

PatchSum sum_patch(const ProbeHits& hits, const HitRange& near, const TouchPoint& touch, const Mat3& bone_from_tool, double edge,
                   const Vec3& mean) noexcept {
  PatchSum sum;
  const std::size_t every = std::max<std::size_t>(1, (near.last - near.first) / kAsked);
  for (std::size_t n = near.first; n < near.last; n += every) {
    const double beyond = std::abs(static_cast<double>(hits.distance[n]) - touch.gap);
    if (beyond >= kNearly) continue;
    const Vec3 place(static_cast<double>(hits.x[n]), static_cast<double>(hits.y[n]), static_cast<double>(hits.z[n]));
    const Vec3 way = bone_from_tool * (place - touch.place) / edge;
    const double way2 = glm::dot(way, way);
    if (way2 >= kReach * kReach) continue;
    const Vec3 normal(static_cast<double>(hits.nx[n]), static_cast<double>(hits.ny[n]), static_cast<double>(hits.nz[n]));
    const double alike = (glm::dot(normal, mean) - kAlike) / (1.0 - kAlike);
    if (alike <= 0.0) continue;
    // The rate at which normals lean towards each other; over half a voxel and less it would be of their noise.
    const double bend = -glm::dot(normal - touch.normal, way) / (way2 + 0.25);
    const double weight = (1.0 - beyond / kNearly) * alike, level = weight * std::clamp(1.5 + bend / kBulge, 0.0, 1.0);
    sum.all += weight;
    sum.level += level;
    sum.normal += normal * level;
  }
  return sum;
}

}  // namespace

Vec3 hollow_direction(const ProbeHits& hits, const HitRange& near, const TouchPoint& touch, const Mat3& bone_from_tool,
                      double edge) noexcept {
  Vec3 mean = touch.normal;
  double share = 0.0;
  for (int pass = 0; pass < kPasses; ++pass) {
    const PatchSum sum = sum_patch(hits, near, touch, bone_from_tool, edge, mean);
    const double length = glm::length(sum.normal);
    if (!(length > 0.0)) return touch.steadied;
    mean = sum.normal / length;
    share = std::clamp((sum.level / sum.all - kLeastShare) / (kWholeShare - kLeastShare), 0.0, 1.0);
  }
  return glm::normalize(touch.steadied * (1.0 - share) + mean * share);
}

}  // namespace burrhole
