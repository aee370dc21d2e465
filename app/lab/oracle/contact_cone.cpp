#include "app/lab/oracle/contact_cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/bounds.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr double kHalfDiagonal = 0.8660254037844387;  // [voxel edges] of a cell
constexpr int kDeep = 3;                              // [voxel edges]
constexpr double kRounding = 1e-12;                   // [-] of the force

/// The nearest point of the cone of up to four vectors, testing every pair: in 3D the nearest point is the vertex, on a ray, on a face
/// between two rays, or the force itself.
Vec3 nearest_on_faces(const Vec3& force, std::span<const Vec3> rays) noexcept {
  Vec3 best(0.0);
  double least = glm::dot(force, force);
  const auto consider = [&](const Vec3& place) {
    const Vec3 off = force - place;
    if (glm::dot(off, off) < least) {
      least = glm::dot(off, off);
      best = place;
    }
  };
  for (std::size_t a = 0; a < rays.size(); ++a) {
    consider(rays[a] * std::max(0.0, glm::dot(force, rays[a])));
    for (std::size_t b = 0; b < a; ++b) {
      const double along = glm::dot(rays[a], rays[b]), whole = 1.0 - along * along;
      if (whole < 1e-9) continue;  // parallel or opposed: the rays cover this case
      const double fa = glm::dot(force, rays[a]), fb = glm::dot(force, rays[b]);
      const double pa = (fa - along * fb) / whole, pb = (fb - along * fa) / whole;
      if (pa > 0.0 && pb > 0.0) consider(rays[a] * pa + rays[b] * pb);
    }
  }
  return best;
}

/// The eight densities of a cell, x fastest.
using Corners = std::array<double, 8>;

Corners corners_of(const MasterWindow& window, const Vec3i& cell) {
  Corners out;
  for (unsigned n = 0; n < 8; ++n) out[n] = static_cast<double>(window.density[window.box.offset_of(cell + cell_corner(n))]);
  return out;
}

/// Mean of the crossings of the 0.5 surface with the edges, in cell coordinates 0..1; nothing if it does not pass.
std::optional<Vec3> crossing_of(const Corners& density) noexcept {
  Vec3 sum(0.0);
  double count = 0.0;
  for (unsigned from = 0; from < 8; ++from)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const unsigned to = from | (1u << axis);
      if (to == from || (density[from] < 0.5) == (density[to] < 0.5)) continue;
      Vec3 at(cell_corner(from));
      at[axis] += (0.5 - density[from]) / (density[to] - density[from]);
      sum += at;
      count += 1.0;
    }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

/// Gradient of the density between the corners.
Vec3 slope_of(const Corners& density, const Vec3& at) noexcept {
  Vec3 out(0.0);
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double weight = 1.0;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool up = ((n >> a) & 1) != 0;
        weight *= a == axis ? (up ? 1.0 : -1.0) : (up ? at[a] : 1.0 - at[a]);
      }
      out[axis] += weight * density[n];
    }
  return out;
}

/// A position where the surface passes.
struct Passing {
  Vec3 at;  // [voxels]
  Vec3 normal;
};

std::vector<Passing> find_passing(const MasterWindow& window, const Mat3& bone_from_slope, const VoxelBox& cells) {
  std::vector<Passing> out;
  for_each_voxel(cells, [&](const Vec3i& cell) {
    const Corners density = corners_of(window, cell);
    const auto at = crossing_of(density);
    if (!at) return;
    const Vec3 normal = bone_from_slope * -slope_of(density, *at);
    if (glm::length(normal) > 0.0) out.push_back({Vec3(cell) + *at, glm::normalize(normal)});
  });
  return out;
}

}  // namespace

double outside_cone(const Vec3& force, std::span<const Vec3> normals) noexcept {
  // Wolfe's method: up to three rays span the active face or corner. The normal with the largest component along the residual is added,
  // until there is none. Each iteration reduces the distance, so there are at most as many iterations as normals.
  const double size = glm::length(force);
  std::vector<Vec3> rays;
  Vec3 place(0.0);
  for (std::size_t round = 0; round <= normals.size(); ++round) {
    const Vec3 left = force - place;
    if (glm::length(left) <= kRounding * size) return 0.0;
    const auto next = std::ranges::max_element(normals, {}, [&](const Vec3& n) { return glm::dot(n, left); });
    if (next == normals.end() || glm::dot(*next, left) <= kRounding * size) return glm::length(left);
    rays.push_back(*next);
    const Vec3 nearer = nearest_on_faces(force, rays);
    // No face is nearer than before although a normal points towards the force: the force is between the rays, inside the cone.
    const Vec3 off = force - nearer;
    if (std::ranges::none_of(rays, [&](const Vec3& n) { return glm::dot(n, off) > kRounding * size; })) {
      place = nearer;
      continue;
    }
    return 0.0;
  }
  return glm::length(force - place);
}

void touched_normals(const MasterWindow& window, const Affine& bone_from_index, std::span<const Vec3> points_in_bone,
                     std::vector<Vec3>& out) {
  const Affine index_from_bone = bone_from_index.inverse();
  const VoxelBox known{window.box.lo, window.box.hi - 1};  // cells, by their lowest corner
  VoxelBox cells;
  std::vector<Vec3> points;
  for (const Vec3& point : points_in_bone) {
    const Vec3 index = index_from_bone * point;
    const Vec3i cell = floor_int(index);
    if (!known.contains(cell)) continue;
    points.push_back(index);
    cells = cells.unite({cell - kDeep, cell + kDeep + 1});
  }
  const std::vector<Passing> passing = find_passing(window, glm::transpose(index_from_bone.linear), cells.intersect(known));
  std::vector<double> distance(passing.size());
  std::vector<char> touched(passing.size(), 0);
  for (const Vec3& point : points) {
    for (std::size_t n = 0; n < passing.size(); ++n) distance[n] = glm::length(passing[n].at - point);
    double reach = kHalfDiagonal;
    if (trilinear(window.box, window.density.data(), point) >= 0.5 && !passing.empty()) {
      const double nearest = std::ranges::min(distance);
      reach = nearest <= kDeep ? nearest + kHalfDiagonal : 0.0;
    }
    for (std::size_t n = 0; n < passing.size(); ++n)
      if (distance[n] <= reach) touched[n] = 1;
  }
  for (std::size_t n = 0; n < passing.size(); ++n)
    if (touched[n] != 0) out.push_back(passing[n].normal);
}

}  // namespace burrhole
