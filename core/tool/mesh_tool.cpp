#include "core/tool/mesh_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tool/mesh_slices.h"

namespace burrhole {
namespace {

/// Half-open range of lattice cells; centres at (n + 1/2) pitch.
struct Cells {
  Vec3i lo{0}, hi{0};
};

double centre(int n, double pitch) noexcept { return (static_cast<double>(n) + 0.5) * pitch; }

Error too_many(double pitch) {
  return {
      ErrorCode::out_of_range,
      fmt::format("an erosion pitch of {:g} mm makes more than {} erosion points: take a coarser pitch", pitch * 1e3, kMaxErosionPoints),
      {}};
}

/// Cells around the mesh at cutting heights. Nothing if their volume is ten times the limit: filling them would be slow and fail anyway.
bool find_cells(const MeshToolSpec& spec, const SurfaceMesh& mesh, double pitch, Cells& cells) {
  Vec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (const Vec3& p : mesh.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  lo.z = std::max(lo.z, spec.cut_from);
  hi.z = std::min(hi.z, spec.cut_to);
  const Vec3 first = glm::floor(lo / pitch), last = glm::max(glm::ceil(hi / pitch), first);
  const Vec3 size = last - first;
  if (size.x * size.y * size.z > 50.0 * static_cast<double>(kMaxErosionPoints)) return false;
  const double farthest = std::numeric_limits<int>::max() / 2;
  if (glm::any(glm::greaterThan(glm::max(glm::abs(first), glm::abs(last)), Vec3(farthest)))) return false;
  cells = {Vec3i(first), Vec3i(last)};
  return true;
}

}  // namespace

Result<ErosionPoints> make_mesh_erosion_points(const MeshToolSpec& spec, const SurfaceMesh& mesh, double pitch) {
  if (!std::isfinite(pitch) || pitch <= 0.0)
    return Error{ErrorCode::out_of_range, fmt::format("erosion pitch = {:g} mm must be > 0", pitch * 1e3), {}};
  ErosionPoints points;
  points.pitch = pitch;
  if (spec.erosion_factor <= 0.0) return points;
  Cells cells;
  if (!find_cells(spec, mesh, pitch, cells)) return too_many(pitch);
  const PointLattice lattice{{centre(cells.lo.x, pitch), centre(cells.lo.y, pitch), centre(cells.lo.z, pitch)}, pitch, cells.hi - cells.lo};
  for_each_slice(mesh, lattice, [&](int k, std::span<const std::uint8_t> inside) {
    const double z = centre(cells.lo.z + k, pitch);
    if (!spec.cuts_at(z)) return true;
    std::size_t at = 0;
    for (int j = cells.lo.y; j < cells.hi.y; ++j)
      for (int i = cells.lo.x; i < cells.hi.x; ++i)
        if (inside[at++]) points.positions.emplace_back(centre(i, pitch), centre(j, pitch), z);
    return points.positions.size() <= kMaxErosionPoints;
  });
  if (points.positions.size() > kMaxErosionPoints) return too_many(pitch);
  points.factors.assign(points.positions.size(), static_cast<float>(spec.erosion_factor));
  return points;
}

TriangleMesh make_mesh_picture(const SurfaceMesh& mesh) {
  TriangleMesh picture;
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const Vec3 &a = mesh.positions[mesh.indices[n]], &b = mesh.positions[mesh.indices[n + 1]], &c = mesh.positions[mesh.indices[n + 2]];
    const Vec3 area = glm::cross(b - a, c - a);
    const double length = glm::length(area);
    if (!(length > 0.0)) continue;
    for (const Vec3* p : {&a, &b, &c}) {
      picture.indices.push_back(static_cast<std::uint32_t>(picture.positions.size()));
      picture.positions.emplace_back(*p);
      picture.normals.emplace_back(area / length);
    }
  }
  return picture;
}

}  // namespace burrhole
