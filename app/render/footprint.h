/// app/render/footprint.h: which pixels of a picture a change in the scene may reach. No OpenGL.
///   Units  pixels, row 0 at the bottom as OpenGL counts them; index coordinates as in volume.glsl.   Source  own derivation, in footprint.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/render/camera.h"

namespace burrhole {

struct RenderOptions;

using Vec2 = glm::dvec2;
using Vec2i = glm::ivec2;

/// Half-open: lo <= (column, row) < hi.
struct PixelRect {
  Vec2i lo{0}, hi{0};

  [[nodiscard]] bool empty() const noexcept { return hi.x <= lo.x || hi.y <= lo.y; }
  [[nodiscard]] Vec2i size() const noexcept { return hi - lo; }
  [[nodiscard]] std::int64_t count() const noexcept { return empty() ? 0 : std::int64_t{hi.x - lo.x} * (hi.y - lo.y); }
  [[nodiscard]] bool contains(const PixelRect& r) const noexcept {
    return r.empty() || (lo.x <= r.lo.x && lo.y <= r.lo.y && hi.x >= r.hi.x && hi.y >= r.hi.y);
  }
  [[nodiscard]] PixelRect intersect(const PixelRect& r) const noexcept { return {glm::max(lo, r.lo), glm::min(hi, r.hi)}; }
  [[nodiscard]] PixelRect grown(int n) const noexcept { return {lo - n, hi + n}; }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// A few disjoint rectangles, none of them empty.
class PixelRegion {
 public:
  static constexpr std::size_t kMost = 8;

  /// Two that nearly fill the rectangle round both become that; beyond kMost all do.
  void add(const PixelRect& rect);
  [[nodiscard]] std::span<const PixelRect> rects() const noexcept { return rects_; }
  [[nodiscard]] std::int64_t pixels() const noexcept;

 private:
  std::vector<PixelRect> rects_;
};

/// How far from a changed texel the samples lie that a picture takes for one point of a ray.
struct Reach {
  double voxels = 0.0;  ///< along each index axis
  double metres = 0.0;  ///< in any direction
};

/// What the shaders of these options reach; each figure is that of the shader's text. @param longest_edge of a voxel [m].
[[nodiscard]] Reach reach_of(const RenderOptions& options, double longest_edge) noexcept;

/// Corners in the world of all points of rays whose samples may meet a texel of `box`.
[[nodiscard]] std::vector<Vec3> reached_corners(const VoxelBox& box, const Reach& reach, const Affine& world_from_index);

/// The rectangle of all pixels whose rays meet the convex hull of the points, cut to the picture; all of the picture when one of the points
/// is not in front of the eye.
[[nodiscard]] PixelRect find_footprint(const CameraRays& rays, std::span<const Vec3> points, const Vec2i& picture);

}  // namespace burrhole
