#include "core/contact/shell_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

// [-] Slope of the distance along the tool towards the edge of a wedge of 36 degrees; and [voxel edges] what a move may add before the next
// probe.
constexpr double kSteepest = 0.95, kMargin = 0.1;
constexpr double kMeasured = 0.97;  // [-] of the measured curvature: the face may be less curved beside the place
constexpr int kDirections = 8;      // along a face, in which its curvature is measured
constexpr double kSine[kDirections] = {0.0, 0.70710678, 1.0, 0.70710678, 0.0, -0.70710678, -1.0, -0.70710678};

/// [1/m] The least curvature of the tool's surface at p, over a distance of `reach` [m] along it; at least 0.
double least_curvature(const ToolSurface& surface, const Vec3& p, const Vec3& outward, double reach) {
  const Vec3 side = std::abs(outward.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
  const Vec3 u = glm::normalize(glm::cross(outward, side)), v = glm::cross(outward, u);
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kDirections; ++n) {
    const Vec3 way = reach * (kSine[(n + 2) % kDirections] * u + kSine[n] * v);
    const auto at = surface.nearest(p + way + reach * outward);
    if (!at) return 0.0;
    const Vec3 off = *at - p;
    const double back = -glm::dot(off, outward), along2 = std::max(glm::dot(off, off) - back * back, 1e-18);
    least = std::min(least, 2.0 * back / along2);
  }
  return std::max(0.0, kMeasured * least);
}

float dot(const Vec3f& a, const Vec3f& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

ShellCells::ShellCells(const PointShell& shell, const ToolSurface& surface, double voxel_edge) : cells_(shell.size()) {
  for (std::size_t n = 0; n < shell.size(); ++n) {
    const Vec3& p = shell.positions[n];
    const ToolFaces faces = surface.faces_at(p);
    Cell& cell = cells_[n];
    cell.faces = static_cast<int>(faces.count);
    cell.radius = static_cast<float>(faces.cell_radius / voxel_edge);
    double& reach = reach_[shell.cutting[n] != 0 ? 1 : 0];
    reach = std::max(reach, kSteepest * faces.cell_radius / voxel_edge + kMargin);
    if (faces.count == 0) {
      // A corner, an apex or a joint: the way into a face leads back from bone, so a flat face across it has the larger bound.
      cell.faces = 1;
      cell.outward = Vec3f(-shell.inward_normals[n]);
      continue;
    }
    cell.outward = Vec3f(faces.face[0].outward);
    cell.into = Vec3f(faces.face[0].into);
    if (faces.count == 1) {
      cell.curvature = static_cast<float>(least_curvature(surface, p, faces.face[0].outward, faces.cell_radius) * voxel_edge);
      continue;
    }
    cell.outward2 = Vec3f(faces.face[1].outward);
    cell.into2 = Vec3f(faces.face[1].into);
    cell.along = Vec3f(glm::normalize(glm::cross(faces.face[0].outward, faces.face[1].outward)));
  }
}

float ShellCells::drop(const Cell& cell, const Vec3f& normal) noexcept {
  float along2 = 0.0f;
  if (cell.faces == 1) {
    const float facing = dot(normal, cell.outward);
    if (facing >= 0.0f) return 0.0f;  // the far side of the tool
    along2 = dot(normal, normal) - facing * facing;
  } else {
    const float edge = dot(normal, cell.along);
    const float first = std::max(0.0f, -dot(normal, cell.into)), second = std::max(0.0f, -dot(normal, cell.into2));
    along2 = edge * edge + std::max(first * first, second * second);
  }
  if (along2 * cell.radius * cell.radius <= kSlack * kSlack) return 0.0f;
  const float along = std::sqrt(along2);
  const float reach = cell.curvature * cell.radius > along ? along / cell.curvature : cell.radius;
  return std::max(0.0f, along * reach - 0.5f * cell.curvature * reach * reach - kSlack);
}

void ShellCells::lower(const Mat3& bone_from_tool, ProbeHits& hits) const noexcept {
  const Mat3 m = glm::transpose(bone_from_tool);
  const Vec3f a(m[0]), b(m[1]), c(m[2]);
  for (std::size_t n = 0; n < hits.count; ++n) {
    const Cell& cell = cells_[hits.point[n]];
    hits.lower[n] = hits.distance[n];
    hits.lower[n] -= drop(cell, a * hits.nx[n] + b * hits.ny[n] + c * hits.nz[n]);
  }
  for (std::size_t n = 0; n < hits.blocks.count; ++n) {
    const HitRange range = hits.blocks.hits_of(n);
    float least = hits.blocks.distance[n];
    for (std::size_t k = range.first; k < range.last; ++k) least = std::min(least, hits.lower[k]);
    hits.blocks.distance[n] = least;
  }
  hits.lowered = true;
}

void ShellCells::copy(ProbeHits& hits) noexcept {
  std::copy_n(hits.distance.begin(), hits.count, hits.lower.begin());
  hits.lowered = true;
}

}  // namespace burrhole
