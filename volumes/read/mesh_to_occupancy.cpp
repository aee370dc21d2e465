#include "volumes/read/mesh_to_occupancy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <span>

#include "core/base/bounds.h"
#include "core/tool/mesh_slices.h"

// Two sweeps over the slices. The first writes 1 inside and 0 outside. The second processes the voxels with a neighbour (of 26) on the
// other side. Only these can be within w of a surface between solid and air: from a voxel at distance d < w of a plane, the step by one
// voxel along (sign nx, sign ny, sign nz) moves w along n and so across the plane. Walls inside a union of overlapping parts have no such
// voxels and stay solid. Each processed voxel gets its nearest point on the triangles within reach, slab by slab.

namespace burrhole {
namespace {

/// A voxel and its neighbour across the surface are at most a cell's diagonal apart, sqrt(3) = 1.7321, plus a reserve for rounding.
constexpr double kReach = 1.74;  // [voxels]

Vec3 nearest_on_edge(const Vec3& a, const Vec3& b, const Vec3& p) noexcept {
  const Vec3 along = b - a;
  const double length2 = glm::dot(along, along);
  return length2 > 0.0 ? a + along * std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : a;
}

/// The foot on the plane if it is inside the triangle, else the nearest point of the three edges.
Vec3 nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) noexcept {
  const Vec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0.0 && glm::dot(glm::cross(b - a, p - a), normal) >= 0.0 && glm::dot(glm::cross(c - b, p - b), normal) >= 0.0 &&
      glm::dot(glm::cross(a - c, p - c), normal) >= 0.0)
    return p - normal * (glm::dot(p - a, normal) / area2);
  const Vec3 feet[] = {nearest_on_edge(a, b, p), nearest_on_edge(b, c, p), nearest_on_edge(c, a, p)};
  return *std::min_element(std::begin(feet), std::end(feet),
                           [&](const Vec3& f, const Vec3& g) { return glm::dot(f - p, f - p) < glm::dot(g - p, g - p); });
}

struct Nearest {
  double distance2 = std::numeric_limits<double>::infinity();
  Vec3 offset{0.0};  ///< from the surface to the voxel
  std::uint32_t triangle = 0;
};

/// The second sweep, which converts signs to ramps. Index space throughout: the mesh is scaled to voxels.
class RampSweep {
 public:
  RampSweep(const SurfaceMesh& mesh, const Vec3i& dims, std::vector<float>& values)
      : mesh_(mesh), dims_(dims), values_(values), area_(static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y)) {
    band_.resize(area_);
    sums_.resize(area_);
    nearest_.resize(area_);
  }

  Status run(const std::function<Status(double)>& advance) {
    const std::size_t triangles = mesh_.indices.size() / 3;
    std::vector<std::uint32_t> waiting(triangles), active;
    std::iota(waiting.begin(), waiting.end(), 0u);
    std::sort(waiting.begin(), waiting.end(), [&](auto a, auto b) { return lowest(a) != lowest(b) ? lowest(a) < lowest(b) : a < b; });
    std::size_t next = 0;
    for (int k = 1; k + 1 < dims_.z; ++k) {
      std::erase_if(active, [&](std::uint32_t t) { return highest(t) < k - kReach; });
      for (; next < triangles && lowest(waiting[next]) <= k + kReach; ++next) active.push_back(waiting[next]);
      if (!mark_band(k)) continue;
      for (const std::uint32_t t : active) visit(t, k);
      write(k);
      if (!advance) continue;
      if (Status on = advance(static_cast<double>(k) / dims_.z); !on) return on;
    }
    return {};
  }

 private:
  const Vec3& corner(std::uint32_t t, std::size_t n) const { return mesh_.positions[mesh_.indices[3 * std::size_t{t} + n]]; }
  double lowest(std::uint32_t t) const { return std::min({corner(t, 0).z, corner(t, 1).z, corner(t, 2).z}); }
  double highest(std::uint32_t t) const { return std::max({corner(t, 0).z, corner(t, 1).z, corner(t, 2).z}); }
  bool solid(std::size_t at) const { return values_[at] >= 0.5f; }
  std::size_t row(int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(dims_.x); }

  /// Marks the voxels of slice k whose block of 27 is neither all solid nor all air. The margin of the grid keeps the block inside it.
  bool mark_band(int k) {
    const std::size_t here = static_cast<std::size_t>(k) * area_, width = static_cast<std::size_t>(dims_.x);
    for (std::size_t at = 0; at < area_; ++at)
      sums_[at] = static_cast<std::uint8_t>(solid(here - area_ + at) + solid(here + at) + solid(here + area_ + at));
    bool any = false;
    for (int j = 1; j + 1 < dims_.y; ++j)
      for (std::size_t at = row(j) + 1; at + 1 < row(j + 1); ++at) {
        int sum = 0;
        for (const std::size_t centre : {at - width, at, at + width}) sum += sums_[centre - 1] + sums_[centre] + sums_[centre + 1];
        band_[at] = sum > 0 && sum < 27 ? 1 : 0;
        if (band_[at]) {
          nearest_[at] = {};
          any = true;
        }
      }
    return any;
  }

  /// Tests a triangle against the band voxels within reach of its part near slice k.
  void visit(std::uint32_t t, int k) {
    Vec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
    const auto include = [&](const Vec3& p) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    };
    const double low = k - kReach, high = k + kReach;
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3 &a = corner(t, n), &b = corner(t, (n + 1) % 3);
      if (a.z >= low && a.z <= high) include(a);
      for (const double z : {low, high})
        if ((a.z < z) != (b.z < z)) include(a + (b - a) * ((z - a.z) / (b.z - a.z)));
    }
    if (!(lo.x <= hi.x)) return;
    const int i0 = std::max(1, floor_int(lo.x - kReach)), i1 = std::min(dims_.x - 2, floor_int(hi.x + kReach) + 1);
    const int j0 = std::max(1, floor_int(lo.y - kReach)), j1 = std::min(dims_.y - 2, floor_int(hi.y + kReach) + 1);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i)
        if (band_[row(j) + static_cast<std::size_t>(i)]) offer(t, Vec3(i, j, k), nearest_[row(j) + static_cast<std::size_t>(i)]);
  }

  void offer(std::uint32_t t, const Vec3& p, Nearest& best) const {
    const Vec3 offset = p - nearest_on_triangle(corner(t, 0), corner(t, 1), corner(t, 2), p);
    const double distance2 = glm::dot(offset, offset);
    if (distance2 < best.distance2) best = {distance2, offset, t};
  }

  /// w of the ramp [voxels]; on the surface itself it uses the normal of the triangle.
  double half_width(const Nearest& near) const {
    Vec3 n = near.offset;
    if (near.distance2 < 1e-18)
      n = glm::cross(corner(near.triangle, 1) - corner(near.triangle, 0), corner(near.triangle, 2) - corner(near.triangle, 0));
    const double length = glm::length(n);
    return length > 0.0 ? (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) / length : 1.0;
  }

  void write(int k) {
    const float below_half = std::nextafter(0.5f, 0.0f);
    for (std::size_t at = 0; at < area_; ++at) {
      if (!band_[at] || !std::isfinite(nearest_[at].distance2)) continue;
      const double step = std::min(0.5, std::sqrt(nearest_[at].distance2) / (2.0 * half_width(nearest_[at])));
      float& value = values_[static_cast<std::size_t>(k) * area_ + at];
      value = value >= 0.5f ? static_cast<float>(0.5 + step) : std::min(below_half, static_cast<float>(0.5 - step));
    }
  }

  const SurfaceMesh& mesh_;
  const Vec3i dims_;
  std::vector<float>& values_;
  const std::size_t area_;
  std::vector<std::uint8_t> band_, sums_;
  std::vector<Nearest> nearest_;
};

}  // namespace

Vec3 mesh_grid_dims(const Vec3& size, double pitch) noexcept { return glm::ceil(size / pitch) + (1.0 + 2.0 * kMeshMargin); }

Result<Scan> mesh_to_occupancy(const SurfaceMesh& mesh, double pitch, const std::function<Status(double)>& advance) {
  const Bounds box = bounds_of_points(mesh.positions);
  Scan scan;
  scan.dims = Vec3i(mesh_grid_dims(box.hi - box.lo, pitch));
  scan.quantity = Quantity::occupancy;
  // The excess of the grid over the box is divided equally between both sides.
  const Vec3 origin = 0.5 * (box.lo + box.hi) - 0.5 * pitch * (Vec3(scan.dims) - 1.0);
  scan.bone_from_index = Affine::scaling(pitch, origin);
  try {
    scan.values.assign(VoxelBox{Vec3i(0), scan.dims}.count(), 0.0f);
    SurfaceMesh in_voxels = mesh;
    for (Vec3& p : in_voxels.positions) p = (p - origin) / pitch;
    for_each_slice(in_voxels, {Vec3(0.0), 1.0, scan.dims}, [&](int k, std::span<const std::uint8_t> inside) {
      std::copy(inside.begin(), inside.end(), scan.values.begin() + static_cast<std::ptrdiff_t>(inside.size()) * k);
      return true;
    });
    if (const Status done = RampSweep(in_voxels, scan.dims, scan.values).run(advance); !done) return done.error();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::unavailable,
                 fmt::format("no memory for {} x {} x {} voxels: take a coarser pitch", scan.dims.x, scan.dims.y, scan.dims.z),
                 {}};
  }
  if (advance)
    if (const Status done = advance(1.0); !done) return done.error();
  return scan;
}

}  // namespace burrhole
