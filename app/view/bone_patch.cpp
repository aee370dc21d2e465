#include "app/view/bone_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/view/surface_nets.h"

namespace burrhole {

void DensityBytes::set(const VoxelBox& voxels, std::span<const float> density) noexcept {
  for_each_voxel(voxels.intersect(box_), [&](const Vec3i& voxel) {
    const float value = std::clamp(density[voxels.offset_of(voxel)], 0.0f, 1.0f);
    bytes_[box_.offset_of(voxel)] = static_cast<std::uint8_t>(std::lround(255.0f * value));
  });
}

void DensityBytes::copy(const VoxelBox& part, std::vector<std::uint8_t>& out) const {
  out.resize(part.count());
  const auto row = static_cast<std::ptrdiff_t>(part.size().x);
  auto to = out.begin();
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j, to += row)
      std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(box_.offset_of({part.lo.x, j, k})), row, to);
}

TriangleMesh make_bone_patch(const BonePatch& patch) {
  const VoxelBox& box = patch.box;
  if (box.empty()) return {};
  int stride = 1;
  const auto points = [&] {
    const Vec3i size = (box.size() + stride - 1) / stride + 1;
    return VoxelBox{Vec3i(0), size}.count();
  };
  while (points() > kMostPatchPoints) ++stride;
  const FieldAt field = [&](const Vec3& index) {
    const Vec3i voxel = voxel_of(index);
    if (!box.contains(voxel)) return std::numeric_limits<double>::quiet_NaN();
    return 0.5 - static_cast<double>(patch.density[box.offset_of(voxel)]) / 255.0;
  };
  TriangleMesh mesh = make_surface_mesh(field, {Vec3(box.lo), Vec3(box.hi - 1)}, stride);
  const Affine& map = patch.bone_from_index;
  const Mat3 turned = glm::transpose(glm::inverse(map.linear));  // of normals
  const double lift = patch.lift * map.mean_edge();
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) {
    const Vec3 normal = glm::normalize(turned * Vec3(mesh.normals[n]));
    mesh.positions[n] = Vec3f(map * Vec3(mesh.positions[n]) + lift * normal);
    mesh.normals[n] = Vec3f(normal);
  }
  if (glm::determinant(map.linear) < 0.0)
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3) std::swap(mesh.indices[n + 1], mesh.indices[n + 2]);
  return mesh;
}

}  // namespace burrhole
