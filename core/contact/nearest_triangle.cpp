#include "core/contact/nearest_triangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

/// The place of a triangle that is nearest to a point.
struct Nearest {
  Vec3 from_place{0.0};  // [m] from it to the point
  double weight = 0.0;   // [rad] angle of the triangle there: two pi in its face, pi on an edge
};

/// By the regions of a triangle: vertices, edges, face (Ericson 2005, section 5.1.5).
Nearest nearest_on(const PatchTriangle& triangle, const Vec3& point) noexcept {
  constexpr double kPi = std::numbers::pi;
  const std::array<Vec3, 3> p{Vec3(triangle.corners[0]), Vec3(triangle.corners[1]), Vec3(triangle.corners[2])};
  const Vec3 ab = p[1] - p[0], ac = p[2] - p[0], ap = point - p[0];
  const auto at_corner = [&](std::size_t n) { return Nearest{point - p[n], static_cast<double>(triangle.angles[n])}; };
  const auto on_edge = [&](const Vec3& from, const Vec3& along, double share) { return Nearest{point - (from + share * along), kPi}; };
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return at_corner(0);
  const Vec3 bp = point - p[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return at_corner(1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return on_edge(p[0], ab, d1 / (d1 - d3));
  const Vec3 cp = point - p[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return at_corner(2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return on_edge(p[0], ac, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) return on_edge(p[1], p[2] - p[1], (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double scale = 1.0 / (va + vb + vc);
  return {point - (p[0] + ab * (vb * scale) + ac * (vc * scale)), 2.0 * kPi};
}

double distance2_to(const PatchBounds& bounds, const Vec3& point) noexcept {
  const Vec3 off = glm::max(glm::max(Vec3(bounds.lo) - point, point - Vec3(bounds.hi)), Vec3(0.0));
  return glm::dot(off, off);
}

/// Triangles at one place differ in their squared distance by rounding: 1e-10 m and a share of 1e-9 are above that, and below any step
/// that a hand can feel.
double widened(double distance2) noexcept { return distance2 * (1.0 + 1e-9) + 1e-20; }

/// A normal of floats is off by up to 1e-7: the square of its length by less than kUnit, a plane over a triangle of millimetres by kFlat [m].
constexpr double kUnit = 1.0 + 1e-6, kFlat = 1e-9;

class Search {
 public:
  Search(const TrianglePatch& patch, const Vec3& point, double bound2) noexcept : patch_(patch), point_(point), limit2_(widened(bound2)) {}

  NearestTriangle run() noexcept {
    const VoxelBox blocks = patch_.block_box();
    const Vec3i home = block_at(point_, 0.0);
    const VoxelBox round = VoxelBox{home - 1, home + 2}.intersect(blocks);
    for_each_voxel(round, [&](const Vec3i& at) { visit(patch_.blocks[blocks.offset_of(at)]); });
    const double reach = std::sqrt(limit2_);
    const VoxelBox range = VoxelBox{block_at(point_, -reach), block_at(point_, reach) + 1}.intersect(blocks);
    if (!round.contains(range)) visit_groups(range, round);
    out_.inside = out_.triangle != nullptr && glm::dot(out_.normals, out_.from_place) < 0.0;
    return out_;
  }

 private:
  /// The block in which a point lies, or at the edge of the patch the nearest one. @param by [m] added along each axis, with the overhang.
  [[nodiscard]] Vec3i block_at(const Vec3& point, double by) const noexcept {
    Vec3i out;
    for (int axis = 0; axis < 3; ++axis) {
      const double overhang = by == 0.0 ? 0.0 : std::copysign(static_cast<double>(TrianglePatch::kOverhang), by);
      const double voxel = index_of(point)[axis] + by * patch_.voxels_per_metre[axis] + overhang;
      out[axis] = static_cast<int>(std::clamp(std::floor(voxel / TrianglePatch::kBlock), 0.0, patch_.blocks_size[axis] - 1.0));
    }
    return out;
  }
  [[nodiscard]] Vec3 index_of(const Vec3& point) const noexcept { return patch_.index_from_patch * point; }

  void visit(const PatchBlock& block) noexcept {
    if (block.triangles.empty() || distance2_to(block.bounds, point_) > limit2_) return;
    for (const PatchTriangle& triangle : block.triangles) compare(triangle);
  }

  void visit_groups(const VoxelBox& range, const VoxelBox& visited) noexcept {
    const VoxelBox blocks = patch_.block_box(), groups = patch_.group_box();
    const VoxelBox group_range{range.lo / TrianglePatch::kGroup, (range.hi - 1) / TrianglePatch::kGroup + 1};
    for_each_voxel(group_range, [&](const Vec3i& group) {
      const PatchBounds& bounds = patch_.groups[groups.offset_of(group)];
      if (bounds.empty() || distance2_to(bounds, point_) > limit2_) return;
      const Vec3i lo = group * TrianglePatch::kGroup;
      for_each_voxel(VoxelBox{lo, lo + TrianglePatch::kGroup}.intersect(range), [&](const Vec3i& at) {
        if (!visited.contains(at)) visit(patch_.blocks[blocks.offset_of(at)]);
      });
    });
  }

  void compare(const PatchTriangle& triangle) noexcept {
    const Vec3 normal(triangle.normal);
    const double depth = glm::dot(Vec3(triangle.corners[0]) - point_, normal);
    if (const double off = std::abs(depth) - kFlat; off > 0.0 && off * off > limit2_ * kUnit) return;  // its plane alone is farther away
    PatchBounds bounds;
    for (const Vec3f& corner : triangle.corners) bounds.include(corner);
    if (distance2_to(bounds, point_) > limit2_) return;
    const Nearest nearest = nearest_on(triangle, point_);
    const double distance2 = glm::dot(nearest.from_place, nearest.from_place);
    if (distance2 > limit2_) return;
    if (out_.triangle == nullptr || widened(distance2) < out_.distance2) {  // nearer than all before
      out_ = {&triangle, distance2, depth, false, nearest.from_place, nearest.weight * normal};
      limit2_ = std::min(limit2_, widened(distance2));
      return;
    }
    out_.normals += nearest.weight * normal;
    if (depth > out_.depth) {
      out_.triangle = &triangle;
      out_.depth = depth;
    }
  }

  const TrianglePatch& patch_;
  const Vec3 point_;
  double limit2_;  // [m^2]
  NearestTriangle out_;
};

}  // namespace

double distance2_to(const PatchTriangle& triangle, const Vec3& point) noexcept {
  const Vec3 from = nearest_on(triangle, point).from_place;
  return glm::dot(from, from);
}

NearestTriangle find_nearest(const TrianglePatch& patch, const Vec3& point, double bound2) noexcept {
  return Search(patch, point, bound2).run();
}

}  // namespace burrhole
