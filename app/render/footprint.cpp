#include "app/render/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/render/renderer.h"

namespace burrhole {
namespace {

/// A filtered look-up sees texels less than a voxel away.
constexpr double kFilter = 1.0;
/// Single precision of a ray's point, a few 1e-4 voxel, and a filter whose weights have 8 bits.
constexpr double kSlackVoxels = 0.05;
/// Of a pixel: rounding of its ray, and a rasteriser's grid of 1/256.
constexpr double kSlackPixels = 0.125;
/// volume.glsl, surface_normal with RECOMPUTED: corners of the voxel round the point.
constexpr double kCorners = 0.5;
/// volume.glsl, surface_normal with FINISH: the wider mean.
constexpr double kWiderMean = 1.25;
/// tissue.glsl, cut_share: bone before the surface.
constexpr double kBefore = 0.75;
/// occlusion.glsl, open_sky: the farthest ring, and how far it starts above the surface [voxel edges].
const double kSkyMetres = 0.0011 * std::exp2(1.15 * 2.0);
constexpr double kSkyLift = 1.2;

/// shadow.glsl, light_reaching: the last sample [m].
double shadow_metres(double longest_edge) noexcept {
  double way = 1.5 * longest_edge;
  for (int i = 0; i < 28; ++i) way += std::min(0.7 * longest_edge * std::pow(1.08, i), 0.001);
  return way;
}

PixelRect around(const PixelRect& a, const PixelRect& b) { return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)}; }

/// What of `whole` lies outside `hole`, as at most four rectangles.
void append_outside(const PixelRect& whole, const PixelRect& hole, std::vector<PixelRect>& out) {
  const PixelRect common = whole.intersect(hole);
  if (common.empty()) {
    out.push_back(whole);
    return;
  }
  const PixelRect parts[] = {{whole.lo, {whole.hi.x, common.lo.y}},
                             {{whole.lo.x, common.hi.y}, whole.hi},
                             {{whole.lo.x, common.lo.y}, {common.lo.x, common.hi.y}},
                             {{common.hi.x, common.lo.y}, {whole.hi.x, common.hi.y}}};
  for (const PixelRect& part : parts)
    if (!part.empty()) out.push_back(part);
}

/// Whether one rectangle round both draws at most an eighth more than both do.
bool worth_joining(const PixelRect& a, const PixelRect& b) {
  return 8 * around(a, b).count() <= 9 * (a.count() + b.count() - a.intersect(b).count());
}

}  // namespace

void PixelRegion::add(const PixelRect& rect) {
  PixelRect all = rect;
  if (all.empty()) return;
  for (std::size_t n = 0; n < rects_.size();) {
    if (!worth_joining(rects_[n], all)) {
      ++n;
      continue;
    }
    all = around(rects_[n], all);
    rects_.erase(rects_.begin() + static_cast<std::ptrdiff_t>(n));
    n = 0;  // larger, it may be worth joining those that it was not
  }
  std::vector<PixelRect> fresh{all};
  for (const PixelRect& kept : rects_) {
    std::vector<PixelRect> outside;
    for (const PixelRect& part : fresh) append_outside(part, kept, outside);
    fresh = std::move(outside);
  }
  rects_.insert(rects_.end(), fresh.begin(), fresh.end());
  if (rects_.size() <= kMost) return;
  for (const PixelRect& r : rects_) all = around(all, r);
  rects_.assign(1, all);
}

std::int64_t PixelRegion::pixels() const noexcept {
  std::int64_t sum = 0;
  for (const PixelRect& r : rects_) sum += r.count();
  return sum;
}

Reach reach_of(const RenderOptions& options, double longest_edge) noexcept {
  Reach out{kFilter + kSlackVoxels, 0.0};
  if (options.translucent) return out;  // normals as stored
  const auto sees = [&out](double voxels) { out.voxels = std::max(out.voxels, kFilter + kSlackVoxels + voxels); };
  if (options.looks.normals == NormalSource::recomputed) sees(kCorners);
  if (options.slices) return out;
  if (options.finish) sees(kWiderMean);
  if (options.looks.tissue) sees(kBefore);
  if (options.looks.occlusion) out.metres = kSkyMetres + kSkyLift * longest_edge;
  if (options.looks.shadow) out.metres = std::max(out.metres, shadow_metres(longest_edge));
  return out;
}

std::vector<Vec3> reached_corners(const VoxelBox& box, const Reach& reach, const Affine& world_from_index) {
  // A ball of radius r [m] reaches r |row a| along index coordinate a, whose gradient in the world is row a of the inverse map.
  const Mat3 rows = glm::transpose(world_from_index.inverse().linear);
  Vec3 grow(0.0);
  for (int a = 0; a < 3; ++a) grow[a] = reach.voxels + reach.metres * glm::length(rows[a]);
  const Vec3 lo = Vec3(box.lo) - grow, hi = Vec3(box.hi - 1) + grow;  // voxel centres lie at integers
  std::vector<Vec3> corners;
  for (unsigned c = 0; c < 8; ++c)
    corners.push_back(world_from_index * Vec3((c & 1u) != 0 ? hi.x : lo.x, (c & 2u) != 0 ? hi.y : lo.y, (c & 4u) != 0 ? hi.z : lo.z));
  return corners;
}

PixelRect find_footprint(const CameraRays& rays, std::span<const Vec3> points, const Vec2i& picture) {
  const PixelRect all{Vec2i(0), picture};
  // A point p = eye + t (forward + x right + y up) has t = (p - eye) . axis and x = (p - eye - t forward) . right / (t right . right), y
  // likewise. The hull's picture is the hull of the points' pictures as long as all of it lies in front of the eye.
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
  // A pixel is drawn by the ray through its middle, half a pixel from its corner.
  const Vec2 first = glm::clamp(glm::ceil(lo - 0.5 - kSlackPixels), Vec2(0.0), Vec2(picture));
  const Vec2 last = glm::clamp(glm::floor(hi - 0.5 + kSlackPixels) + 1.0, Vec2(0.0), Vec2(picture));
  return {Vec2i(first), Vec2i(last)};
}

}  // namespace burrhole
