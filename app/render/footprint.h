/// app/render/footprint.h: the pixels of a picture that a change in the scene can affect. No OpenGL.
///   Frame  pixels, row 0 at the bottom as in OpenGL; index coordinates as in volume.glsl.   Units  pixels.   Errors  none.
///   Source  own derivation, in footprint.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/view/camera.h"
#include "core/base/box_list.h"

namespace burrhole {

struct RenderOptions;

/// [voxels] between a look-up and the texels that it reads, at most: 1, by the filter, and the errors of a point in single precision, a few
/// 1e-4, and of a filter with 8-bit weights.
constexpr double kLookUpVoxels = 1.05;

using Vec2 = glm::dvec2;
using Vec2i = glm::ivec2;

/// Half-open: lo <= (column, row) < hi.
struct PixelRect {
  Vec2i lo{0}, hi{0};  ///< [pixels]

  [[nodiscard]] bool empty() const noexcept { return hi.x <= lo.x || hi.y <= lo.y; }
  [[nodiscard]] Vec2i size() const noexcept { return hi - lo; }
  [[nodiscard]] std::int64_t count() const noexcept { return empty() ? 0 : std::int64_t{hi.x - lo.x} * (hi.y - lo.y); }
  [[nodiscard]] bool contains(const PixelRect& r) const noexcept {
    return r.empty() || (lo.x <= r.lo.x && lo.y <= r.lo.y && hi.x >= r.hi.x && hi.y >= r.hi.y);
  }
  [[nodiscard]] PixelRect intersect(const PixelRect& r) const noexcept { return {glm::max(lo, r.lo), glm::min(hi, r.hi)}; }
  [[nodiscard]] PixelRect unite(const PixelRect& r) const noexcept {
    if (empty()) return r;
    return r.empty() ? *this : PixelRect{glm::min(lo, r.lo), glm::max(hi, r.hi)};
  }
  [[nodiscard]] PixelRect grown(int n) const noexcept { return {lo - n, hi + n}; }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// A few disjoint rectangles, none of them empty.
class PixelRegion {
 public:
  static constexpr std::size_t kMost = 8;

  /// Adds a rectangle. Two rectangles that nearly fill their bounding box are merged; beyond kMost all are.
  void add(const PixelRect& rect);
  [[nodiscard]] std::span<const PixelRect> rects() const noexcept { return rects_.boxes(); }
  [[nodiscard]] std::int64_t pixels() const noexcept { return rects_.count(); }

 private:
  BoxList<PixelRect, kMost> rects_;
};

/// Largest distance from a changed texel to the points of a ray whose samples read it.
struct Reach {
  double voxels = 0.0;     ///< [voxels] along each index axis
  double metres = 0.0;     ///< [m] in any direction, of all samples except those of ambient occlusion
  double occlusion = 0.0;  ///< [m] of the samples of ambient occlusion; 0 if `metres` covers it

  /// @returns the reach of all samples, in `metres`.
  [[nodiscard]] Reach with_occlusion() const noexcept { return {voxels, std::max(metres, occlusion), 0.0}; }
};

/// @returns the reach of the shaders with these options; each value is that of the shader's text. @param longest_edge [m] of a voxel.
[[nodiscard]] Reach reach_of(const RenderOptions& options, double longest_edge) noexcept;

/// @returns the corners, in the world, of the region of ray points whose samples may read a texel of `box` over `reach`, without its
/// `occlusion`.
[[nodiscard]] std::vector<Vec3> reached_corners(const VoxelBox& box, const Reach& reach, const Affine& world_from_index);

/// @returns the rectangle of all pixels whose rays meet the convex hull of the points, clipped to the picture; the whole picture if a point
/// is not in front of the eye.
[[nodiscard]] PixelRect find_footprint(const CameraRays& rays, std::span<const Vec3> points, const Vec2i& picture);

/// What casts a shadow and what shows it, in the world.
struct ShadowScene {
  std::span<const Vec3> caster, receiver;  ///< [m] points whose convex hulls contain them
  Vec3 to_light;                           ///< [-] length 1
};
/// @returns a rectangle with all pixels where the receiver may show the caster's shadow.
[[nodiscard]] PixelRect find_shadow_footprint(const CameraRays& rays, const ShadowScene& scene, const Vec2i& picture);

}  // namespace burrhole
