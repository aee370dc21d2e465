#include "app/render/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/render/renderer.h"
#include "core/base/bounds.h"

namespace burrhole {
namespace {

// [voxels] from a changed voxel to a triangle that differs: its normals depend on voxels up to 4 away, its other corners are one voxel farther, and a
// corner lies up to 1.5 voxels from its voxel.
constexpr double kMeshVoxels = 6.6;

/// [pixels] rounding of the ray, and the 1/256 grid of a rasteriser.
constexpr double kSlackPixels = 0.125;
/// volume.glsl, surface_normal with RECOMPUTED: corners of the voxel around the point.
constexpr double kCorners = 0.5;
/// volume.glsl, surface_normal with FINISH: the wider mean.
constexpr double kWiderMean = 1.25;
/// tissue.glsl, cut_share: bone in front of the surface.
constexpr double kBefore = 0.75;
/// occlusion.glsl: the outermost ring, and its distance above the surface [voxel edges].
const double kSkyMetres = 0.0011 * std::exp2(1.15 * 2.0);
constexpr double kSkyLift = 1.2;

/// shadow.glsl, light_reaching: the last sample [m].
double shadow_metres(double longest_edge) noexcept {
  double way = 1.5 * longest_edge;
  for (int i = 0; i < 28; ++i) way += std::min(0.7 * longest_edge * std::pow(1.08, i), 0.001);
  return way;
}

/// Whether one rectangle round both draws at most an eighth more than both do.
bool worth_joining(const PixelRect& a, const PixelRect& b) {
  return 8 * a.unite(b).count() <= 9 * (a.count() + b.count() - a.intersect(b).count());
}

}  // namespace

void PixelRegion::add(const PixelRect& rect) {
  PixelRect all = rect;
  if (all.empty()) return;
  for (std::size_t n = 0; n < rects_.size();) {
    const PixelRect& kept = rects_.boxes()[n];
    if (!worth_joining(kept, all)) {
      ++n;
      continue;
    }
    all = kept.unite(all);
    rects_.erase(n);
    n = 0;  // larger, it may be worth joining those that it was not
  }
  rects_.add_disjoint(all);
}

Reach reach_of(const RenderOptions& options, double longest_edge) noexcept {
  if (options.mesh) return {kMeshVoxels, 0.0, 0.0};
  Reach out{kLookUpVoxels, 0.0, 0.0};
  if (options.translucent) return out;  // normals as stored
  const auto sees = [&out](double voxels) { out.voxels = std::max(out.voxels, kLookUpVoxels + voxels); };
  if (options.appearance.normals == NormalSource::recomputed) sees(kCorners);
  if (options.slices) return out;
  if (options.finish) sees(kWiderMean);
  if (options.appearance.tissue) sees(kBefore);
  if (options.appearance.occlusion) out.occlusion = kSkyMetres + kSkyLift * longest_edge;
  if (options.appearance.shadow) out.metres = std::max(out.occlusion, shadow_metres(longest_edge));
  if (out.occlusion <= out.metres) out.occlusion = 0.0;
  return out;
}

std::vector<Vec3> reached_corners(const VoxelBox& box, const Reach& reach, const Affine& world_from_index) {
  // A ball of radius r [m] extends by r |row a| along index coordinate a, whose gradient in the world is row a of the inverse map.
  const Mat3 rows = glm::transpose(world_from_index.inverse().linear);
  Vec3 grow(0.0);
  for (int a = 0; a < 3; ++a) grow[a] = reach.voxels + reach.metres * glm::length(rows[a]);
  const Bounds reached{Vec3(box.lo) - grow, Vec3(box.hi - 1) + grow};  // voxel centres lie at integers
  std::vector<Vec3> corners;
  for (const Vec3& corner : reached.corners()) corners.push_back(world_from_index * corner);
  return corners;
}

PixelRect find_footprint(const CameraRays& rays, std::span<const Vec3> points, const Vec2i& picture) {
  const PixelRect all{Vec2i(0), picture};
  // A point p = eye + t (forward + x right + y up) has t = (p - eye) . axis and x = (p - eye - t forward) . right / (t right . right), y
  // likewise. The projection of the hull is the hull of the projected points if the whole hull is in front of the eye.
  Vec2 lo(std::numeric_limits<double>::infinity()), hi(-lo);
  for (const Vec3& p : points) {
    const Vec3 from_eye = p - rays.eye;
    const double t = glm::dot(from_eye, rays.axis);
    if (!(t > 1e-6)) return all;
    const Vec3 off = from_eye - t * rays.forward;
    const Vec2 ndc(glm::dot(off, rays.right) / (t * glm::dot(rays.right, rays.right)),
                   glm::dot(off, rays.up) / (t * glm::dot(rays.up, rays.up)));
    const Vec2 pixel = 0.5 * (ndc + 1.0) * Vec2(picture);
    lo = glm::min(lo, pixel);
    hi = glm::max(hi, pixel);
  }
  // A pixel is drawn by the ray through its centre, half a pixel from its corner.
  const Vec2 first = glm::clamp(glm::ceil(lo - 0.5 - kSlackPixels), Vec2(0.0), Vec2(picture));
  const Vec2 last = glm::clamp(glm::floor(hi - 0.5 + kSlackPixels) + 1.0, Vec2(0.0), Vec2(picture));
  return {Vec2i(first), Vec2i(last)};
}

PixelRect find_shadow_footprint(const CameraRays& rays, const ShadowScene& scene, const Vec2i& picture) {
  const auto heights = [&](std::span<const Vec3> points) {
    Vec2 out(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (const Vec3& p : points) {
      const double height = glm::dot(scene.to_light, p);
      out = {std::min(out.x, height), std::max(out.y, height)};
    }
    return out;
  };
  // The shadow of p is on p - s to_light, s >= 0. It is on the receiver only at heights of the receiver along the light. Between corners the
  // largest s of the hull below is at least that of a point of the caster, as it is a convex function of p; the least is linear or 0.
  const Vec2 caster = heights(scene.caster), receiver = heights(scene.receiver);
  const bool above = caster.x > receiver.y;
  std::vector<Vec3> swept;
  for (const Vec3& p : scene.caster) {
    const double height = glm::dot(scene.to_light, p);
    swept.push_back(p - (above ? height - receiver.y : 0.0) * scene.to_light);
    swept.push_back(p - std::max(0.0, height - receiver.x) * scene.to_light);
  }
  return find_footprint(rays, swept, picture).intersect(find_footprint(rays, scene.receiver, picture));
}

}  // namespace burrhole
