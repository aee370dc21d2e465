/// tests/core/mesh/mesh_cases.h: bones for the tests of the mesh, dense over a box, and changes to them.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/mesh/pivot_rules.h"

namespace burrhole::test {

struct MeshBone {
  VoxelBox box;
  std::vector<float> density;  ///< [-] i fastest

  [[nodiscard]] DensityBlock block() const { return {box, density}; }
  [[nodiscard]] bool is_solid(const Vec3i& v) const { return box.contains(v) && density[box.offset_of(v)] >= 0.5f; }
  void set(const Vec3i& v, bool solid) { density[box.offset_of(v)] = solid ? 1.0f : 0.0f; }
  [[nodiscard]] std::vector<Vec3i> solid_voxels() const;
  [[nodiscard]] std::vector<Vec3i> surface_voxels() const;
};

/// @returns bone of whole voxels where `inside` holds, in a box of `edge` voxels whose lowest corner is at (-3, 5, -20).
[[nodiscard]] MeshBone whole_voxels(const Vec3i& edge, const std::function<bool(const Vec3i& from_corner)>& inside);
/// @returns bone with a ramp of two voxels, as the phantoms have: density clamp(0.5 - d / 2) at signed distance d from the surface, positive
/// outside.
[[nodiscard]] MeshBone ramp(const Vec3i& edge, const std::function<double(const Vec3& from_corner)>& distance);

/// A bone and the name by which a failure reports it.
struct MeshShape {
  std::string name;
  MeshBone bone;
};
/// Small shapes, of at most 9 voxels per edge: block, ball, walls of 1 to 3 voxels, handle, bridge, chain, parts that touch along an edge and
/// at a corner, and noise.
[[nodiscard]] std::vector<MeshShape> small_shapes(std::uint64_t seed);

[[nodiscard]] BallMesh make_mesh(const MeshBone& bone, const BallMeshConfig& config = {}, const PivotRules& rules = {});
/// @returns the elements in a random order.
[[nodiscard]] std::vector<Vec3i> shuffled(std::vector<Vec3i> voxels, std::uint64_t seed);

}  // namespace burrhole::test
