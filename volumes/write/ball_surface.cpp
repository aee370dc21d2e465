#include "volumes/write/ball_surface.h"

#include <fmt/format.h>

#include <utility>

#include "core/mesh/ball_mesh.h"

namespace burrhole {

Result<SurfaceMesh> make_ball_surface(const DensitySource& density) {
  VoxelBox box{};
  for (const VoxelBox& region : density.regions) box = box.unite(region);
  if (box.empty()) return bad_input("there is no bone, so it has no surface");
  box = box.grown(1);  // a vertex may leave its voxel, whose density falls to 0 in the next
  auto mesh = BallMesh::create(box, {.subvoxel = true, .report = false});
  if (!mesh) {
    const Vec3i size = box.size();
    return bad_input(
        fmt::format("a bone of {} x {} x {} voxels is too long for ball pivoting, at most {} per edge: burrhole export writes it", size.x,
                    size.y, size.z, BallMesh::kLongestBox));
  }
  std::vector<float> values(box.count());
  density.read(box, values);
  mesh->fill({box, values});
  SurfaceMesh out = mesh->surface();
  if (out.indices.empty()) return bad_input("no density of the bone is 0.5 or more, so it has no surface");
  const Affine& affine = density.bone_from_index;
  for (Vec3& p : out.positions) p = affine * p;
  if (glm::determinant(affine.linear) < 0.0)
    for (std::size_t n = 0; n + 2 < out.indices.size(); n += 3) std::swap(out.indices[n + 1], out.indices[n + 2]);
  return out;
}

}  // namespace burrhole
