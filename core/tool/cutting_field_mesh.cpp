#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tool/cutting_field.h"
#include "core/tool/mesh_slices.h"

// Distances are computed at the nodes in the box of each triangle, grown by the margin; the sign is the winding number of the slices. Nodes
// that no triangle reaches are at least the margin away and get plus or minus the margin.

namespace burrhole {
namespace {

struct Triangle {
  Vec3 a, b, c;
};

double squared(const Vec3& v) noexcept { return glm::dot(v, v); }

double squared_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 way = b - a;
  const double length2 = squared(way);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, way) / length2, 0.0, 1.0) : 0.0;
  return squared(p - a - t * way);
}

/// Distance to the plane if the foot of the perpendicular lies inside the triangle, else to the nearest edge.
double squared_to_triangle(const Vec3& p, const Triangle& t) noexcept {
  const Vec3 normal = glm::cross(t.b - t.a, t.c - t.a);
  const auto left_of = [&](const Vec3& a, const Vec3& b) { return glm::dot(glm::cross(b - a, p - a), normal) >= 0.0; };
  const double area2 = squared(normal);
  if (area2 > 0.0 && left_of(t.a, t.b) && left_of(t.b, t.c) && left_of(t.c, t.a)) {
    const double height = glm::dot(p - t.a, normal);
    return height * height / area2;
  }
  return std::min({squared_to_segment(p, t.a, t.b), squared_to_segment(p, t.b, t.c), squared_to_segment(p, t.c, t.a)});
}

Bounds bounds_of(const MeshToolSpec& spec, const SurfaceMesh& mesh) {
  Bounds box{Vec3(std::numeric_limits<double>::infinity()), Vec3(-std::numeric_limits<double>::infinity())};
  for (const Vec3& p : mesh.positions) box = {glm::min(box.lo, p), glm::max(box.hi, p)};
  box.lo.z = std::max(box.lo.z, spec.cut_from);
  box.hi.z = std::max(box.lo.z, std::min(box.hi.z, spec.cut_to));
  return box;
}

void lower_distances(const SurfaceMesh& mesh, CuttingField& field) {
  const VoxelBox all{Vec3i(0), field.dims};
  const double reach = field.margin + field.pitch;
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const Triangle t{mesh.positions[mesh.indices[n]], mesh.positions[mesh.indices[n + 1]], mesh.positions[mesh.indices[n + 2]]};
    const Vec3 lo = glm::clamp((glm::min(glm::min(t.a, t.b), t.c) - reach - field.origin) / field.pitch, Vec3(0.0), Vec3(field.dims));
    const Vec3 hi = glm::clamp((glm::max(glm::max(t.a, t.b), t.c) + reach - field.origin) / field.pitch, Vec3(-1.0), Vec3(field.dims - 1));
    for_each_voxel({Vec3i(glm::ceil(lo)), Vec3i(glm::floor(hi)) + 1}, [&](const Vec3i& v) {
      float& d = field.distance[all.offset_of(v)];
      d = std::min(d, static_cast<float>(std::sqrt(squared_to_triangle(field.origin + field.pitch * Vec3(v), t))));
    });
  }
}

}  // namespace

Result<CuttingField> make_mesh_cutting_field(const MeshToolSpec& spec, const SurfaceMesh& mesh, const CuttingFieldSize& size) {
  if (spec.erosion_factor <= 0.0) return CuttingField{};
  const float far = static_cast<float>(size.margin + size.pitch);
  auto field = make_cutting_field(
      bounds_of(spec, mesh), [&](const Vec3&) { return static_cast<double>(far); }, [](const Vec3&) { return 0.0; }, size);
  if (!field) return field;
  lower_distances(mesh, *field);
  std::size_t at = 0;
  for_each_slice(mesh, {field->origin, field->pitch, field->dims}, [&](int k, std::span<const std::uint8_t> inside) {
    const double z = field->origin.z + field->pitch * static_cast<double>(k);
    const auto beyond = static_cast<float>(std::max(spec.cut_from - z, z - spec.cut_to));
    for (const std::uint8_t in : inside) {
      field->distance[at] = std::max(in != 0 ? -field->distance[at] : field->distance[at], beyond);
      field->factor[at] = static_cast<float>(spec.erosion_factor);  // one factor everywhere: no extension needed
      ++at;
    }
    return true;
  });
  return field;
}

}  // namespace burrhole
