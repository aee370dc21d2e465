#include "app/lab/mesh_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kSliver = 20.0;      // [deg]
constexpr double kCell = 2.0;         // [voxel] of the grid that finds what is near
constexpr double kVolumePitch = 0.2;  // [voxel]
constexpr double kDifference = 1e-3;  // [voxel] of a numerical gradient
constexpr double kNotNear = 1e30;     // [voxel]
constexpr int kProjections = 12;

std::array<Vec3, 3> corners_of(const SurfaceMesh& mesh, std::size_t triangle) {
  return {mesh.positions[mesh.indices[3 * triangle]], mesh.positions[mesh.indices[3 * triangle + 1]],
          mesh.positions[mesh.indices[3 * triangle + 2]]};
}

double smallest_angle_deg(const std::array<Vec3, 3>& c) {
  double out = 180.0;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 a = c[(n + 1) % 3] - c[n], b = c[(n + 2) % 3] - c[n];
    out = std::min(out, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi);
  }
  return out;
}

/// Numbers by the cells of a coarse grid that their boxes touch, so that what is near a place is found in rings of cells round it.
class NearGrid {
 public:
  explicit NearGrid(const Bounds& bounds) : lo_(bounds.lo), size_(Vec3i(glm::floor((bounds.hi - bounds.lo) / kCell)) + 1) {
    cells_.resize(VoxelBox{Vec3i(0), size_}.count());
  }
  void add(const Bounds& box, std::uint32_t number) {
    for_each_voxel(VoxelBox{cell(box.lo), cell(box.hi) + 1}, [&](const Vec3i& c) {
      cells_[VoxelBox{Vec3i(0), size_}.offset_of(c)].push_back(number);
    });
  }
  /// @returns the least distance(number) of all. Everything that is in no ring up to the n-th is at least n cells away.
  template <class F>
  [[nodiscard]] double least(const Vec3& p, F&& distance) const {
    const VoxelBox all{Vec3i(0), size_};
    const Vec3i centre = floor_int((p - lo_) / kCell);
    const int most = 1 + std::max({size_.x, size_.y, size_.z}) + static_cast<int>(glm::length(Vec3(centre)));
    double out = kNotNear;
    for (int ring = 0; ring <= most && out > kCell * (ring - 1); ++ring)
      for_each_voxel(VoxelBox{centre - ring, centre + ring + 1}.intersect(all), [&](const Vec3i& c) {
        const Vec3i away = glm::abs(c - centre);
        if (std::max({away.x, away.y, away.z}) != ring) return;
        for (const std::uint32_t number : cells_[all.offset_of(c)]) out = std::min(out, distance(number));
      });
    return out;
  }

 private:
  [[nodiscard]] Vec3i cell(const Vec3& p) const { return glm::clamp(floor_int((p - lo_) / kCell), Vec3i(0), size_ - 1); }
  Vec3 lo_;
  Vec3i size_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

struct Weighted {
  double distance = 0.0, weight = 0.0;
};

/// @param samples those with weight 0 count for the largest only.
MeshDistance summary_of(std::vector<Weighted> samples) {
  std::ranges::sort(samples, {}, &Weighted::distance);
  double weight = 0.0;
  MeshDistance out{.mean = 0.0, .p99 = 0.0, .most = samples.back().distance};
  for (const Weighted& one : samples) {
    weight += one.weight;
    out.mean += one.weight * one.distance;
  }
  out.mean /= weight;
  double below = 0.0;
  for (const Weighted& one : samples) {
    below += one.weight;
    out.p99 = one.distance;
    if (below >= 0.99 * weight) break;
  }
  return out;
}

Vec3 gradient_of(const KnownSurface& surface, const Vec3& p) {
  Vec3 out(0.0);
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    Vec3 step(0.0);
    step[axis] = kDifference;
    out[axis] = (surface.value(p + step) - surface.value(p - step)) / (2.0 * kDifference);
  }
  return out;
}

/// Moves a point of the surface along it towards p until p is straight above it. @returns the distance; that of the start at most.
double projected_distance(const KnownSurface& surface, const Vec3& p, Vec3 q) {
  double out = glm::length(p - q);
  for (int n = 0; n < kProjections; ++n) {
    const Vec3 g = gradient_of(surface, q);
    const double square = glm::dot(g, g);
    if (!(square > 1e-8)) break;
    q += (p - q) - g * (glm::dot(g, p - q) / square);
    for (int step = 0; step < 3; ++step) {
      const Vec3 h = gradient_of(surface, q);
      const double slope = glm::dot(h, h);
      if (!(slope > 1e-8)) return out;
      q -= h * (surface.value(q) / slope);
    }
    if (std::abs(surface.value(q)) < 1e-6) out = std::min(out, glm::length(p - q));
  }
  return out;
}

double crossing_between(const KnownSurface& surface, const Vec3& a, const Vec3& b) {
  double lo = 0.0, hi = 1.0;
  const bool inside = surface.value(a) < 0.0;
  for (int n = 0; n < 30; ++n) {
    const double middle = 0.5 * (lo + hi);
    ((surface.value(a + (b - a) * middle) < 0.0) == inside ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

}  // namespace

double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& c) {
  const Vec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double square = glm::dot(normal, normal);
  bool above = square > 0.0;
  double edges = kNotNear;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 a = c[n], along = c[(n + 1) % 3] - a;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    edges = std::min(edges, glm::length(p - a - along * share));
    above = above && glm::dot(glm::cross(along, p - a), normal) >= 0.0;
  }
  return above ? std::abs(glm::dot(p - c[0], normal)) / std::sqrt(square) : edges;
}

MeshShape measure_mesh_shape(const SurfaceMesh& mesh) {
  const MeshCheck check = check_mesh(mesh);
  MeshShape out{.triangles = check.triangles, .border_edges = check.open_edges, .non_manifold_edges = check.non_manifold_edges};
  out.volume = check.volume;
  out.least_angle_deg = 180.0;
  std::size_t slivers = 0;
  for (std::size_t n = 0; n < check.triangles; ++n) {
    const double angle = smallest_angle_deg(corners_of(mesh, n));
    out.least_angle_deg = std::min(out.least_angle_deg, angle);
    if (angle < kSliver) ++slivers;
  }
  out.below_20_percent = 100.0 * static_cast<double>(slivers) / static_cast<double>(check.triangles);
  return out;
}

std::vector<KnownPoint> sample_surface(const KnownSurface& surface) {
  std::vector<KnownPoint> out;
  const Vec3i count = Vec3i(glm::ceil((surface.bounds.hi - surface.bounds.lo) / kLinePitch)) + 1;
  // Not on the planes of voxels, where the density of a level face has steps.
  const Vec3 first = surface.bounds.lo + 0.137 * kLinePitch;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    Vec3i lines = count;
    lines[axis] = 1;
    Vec3 along(0.0);
    along[axis] = 0.5 * kLinePitch;
    for_each_voxel(VoxelBox{Vec3i(0), lines}, [&](const Vec3i& line) {
      Vec3 p = first + kLinePitch * Vec3(line);
      bool inside = surface.value(p) < 0.0;
      for (int n = 0; n < 2 * count[axis]; ++n, p += along) {
        const bool then = surface.value(p + along) < 0.0;
        if (then == inside) continue;
        inside = then;
        const Vec3 at = p + along * crossing_between(surface, p, p + along);
        const Vec3 g = gradient_of(surface, at);
        const double length = glm::length(g);
        if (!(length > 0.0)) continue;
        const Vec3 normal = g / length, size = glm::abs(normal);
        out.push_back({at, normal, 1.0 / (size.x + size.y + size.z)});
      }
    });
  }
  return out;
}

double volume_of(const KnownSurface& surface) {
  const Vec3 lo = surface.bounds.lo, size = surface.bounds.hi - lo;
  const Vec3i lines = Vec3i(glm::ceil(size / kVolumePitch));
  const Vec3 pitch = size / Vec3(lines);
  const int steps = static_cast<int>(std::ceil(size.x / (0.5 * kLinePitch)));
  const Vec3 along(size.x / steps, 0.0, 0.0);
  double length = 0.0;
  for (int j = 0; j < lines.y; ++j)
    for (int k = 0; k < lines.z; ++k) {
      const Vec3 start = lo + Vec3(0.0, (j + 0.5) * pitch.y, (k + 0.5) * pitch.z);
      bool inside = surface.value(start) < 0.0;
      for (int n = 0; n < steps; ++n) {
        const Vec3 p = start + along * static_cast<double>(n);
        const bool then = surface.value(p + along) < 0.0;
        const double share = then == inside ? (inside ? 1.0 : 0.0) : crossing_between(surface, p, p + along);
        length += along.x * (then == inside || inside ? share : 1.0 - share);
        inside = then;
      }
    }
  return length * pitch.y * pitch.z;
}

MeshDistance distance_to_surface(const SurfaceMesh& mesh, const KnownSurface& surface, const std::vector<KnownPoint>& points) {
  Bounds bounds = Bounds::none();
  for (const KnownPoint& point : points) bounds.include(point.at);
  NearGrid grid(bounds);
  for (std::size_t n = 0; n < points.size(); ++n) grid.add({points[n].at, points[n].at}, static_cast<std::uint32_t>(n));
  const auto distance = [&](const Vec3& p) {
    if (surface.is_distance) return std::abs(surface.value(p));
    double nearest = kNotNear;
    Vec3 start(0.0);
    (void)grid.least(p, [&](std::uint32_t n) {
      const double away = glm::length(p - points[n].at);
      if (away < nearest) {
        nearest = away;
        start = points[n].at;
      }
      return away;
    });
    return projected_distance(surface, p, start);
  };
  std::vector<Weighted> samples;
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const std::array<Vec3, 3> c = corners_of(mesh, n / 3);
    const double quarter = 0.125 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    samples.push_back({distance((c[0] + c[1] + c[2]) / 3.0), quarter});
    for (std::size_t m = 0; m < 3; ++m) {
      samples.push_back({distance((4.0 * c[m] + c[(m + 1) % 3] + c[(m + 2) % 3]) / 6.0), quarter});
      samples.push_back({distance(c[m]), 0.0});
    }
  }
  return summary_of(std::move(samples));
}

MeshDistance distance_to_mesh(const std::vector<KnownPoint>& points, const SurfaceMesh& mesh) {
  NearGrid grid(bounds_of_points(mesh.positions));
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const std::array<Vec3, 3> c = corners_of(mesh, n / 3);
    grid.add(bounds_of_points(c), static_cast<std::uint32_t>(n / 3));
  }
  std::vector<Weighted> samples;
  samples.reserve(points.size());
  for (const KnownPoint& point : points)
    samples.push_back(
        {grid.least(point.at, [&](std::uint32_t n) { return distance_to_triangle(point.at, corners_of(mesh, n)); }), point.weight});
  return summary_of(std::move(samples));
}

}  // namespace burrhole
