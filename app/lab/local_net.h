/// app/lab/local_net.h: surface nets of the density, updated in the changed box only: what the pivoted mesh is compared with.
///   Method   A vertex in each cell of 2 x 2 x 2 voxel centres that has some on both sides of 0.5, at the mean of the crossings of its edges; a
///     quadrangle round each pair of face neighbours on both sides, cut along its shorter diagonal. Density outside of the box is 0.
///   Why not app/view/surface_nets.h   That one samples a function on a lattice of its own and ends open where its box ends: parts cannot be joined.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  one owner.
///   Source  surface nets (Gibson, MICCAI 1998); update and storage: own design.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/vertex_map.h"
#include "core/tool/surface_mesh.h"
#include "core/voxel/gradient.h"

namespace burrhole {

class LocalNet {
 public:
  /// @param onto_surface moves each vertex along the gradient to the 0.5 level of the trilinear density, within its cell. @pre box not empty.
  LocalNet(const VoxelBox& box, bool onto_surface);

  /// The whole net. @pre block.box contains the box.
  void fill(const DensityBlock& block);
  /// Brings the net up to date after the density changed in `changed`, and nowhere else. @pre as fill().
  void update(const DensityBlock& block, const VoxelBox& changed);
  /// @returns the net as two arrays. Allocates.
  [[nodiscard]] SurfaceMesh surface() const;
  [[nodiscard]] std::size_t triangles() const noexcept { return 2 * (quads_.size() - free_quads_.size()); }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  using Quad = std::array<std::uint32_t, 4>;  // counter-clockwise, cut from the first to the third; the first is kNone: free
  static constexpr std::uint32_t kNone = VertexMap::kNone;

  void place_vertex(const DensityBlock& block, const Vec3i& cell);
  void place_quads(const DensityBlock& block, const Vec3i& voxel);
  void set_quad(const DensityBlock& block, const Vec3i& voxel, glm::length_t axis);

  VoxelBox box_;
  bool onto_surface_;
  VertexMap cells_;                 // the vertex of the cell with this lowest corner
  std::array<VertexMap, 3> edges_;  // the quad of the edge from this voxel along each axis
  std::vector<Vec3f> positions_;    // [voxels]
  std::vector<Quad> quads_;
  std::vector<std::uint32_t> free_vertices_, free_quads_;
};

}  // namespace burrhole
