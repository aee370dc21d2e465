/// app/lab/vdb_mesher.h: OpenVDB's volumeToMesh of a density that is kept in a sparse grid, of the whole or of a box.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  one owner; extract() uses no other thread, so that times compare.
#pragma once

#include <memory>

#include "core/tool/surface_mesh.h"
#include "core/voxel/gradient.h"

namespace burrhole {

class VdbMesher {
 public:
  explicit VdbMesher(const DensityBlock& block);
  ~VdbMesher();
  VdbMesher(const VdbMesher&) = delete;
  VdbMesher& operator=(const VdbMesher&) = delete;

  /// Copies the density of a box into the grid.
  void write(const DensityBlock& block, const VoxelBox& changed);
  /// Meshes the whole grid.
  void extract();
  /// Meshes a box of a density, with the cells that a change of it moves. It is closed where the box ends: joining it to the rest of a mesh, which
  /// is left to the caller, would take the polygons of the cells out of both.
  void extract_box(const DensityBlock& block, const VoxelBox& changed);
  /// @returns the mesh that was extracted last, quadrangles cut along their shorter diagonal.
  [[nodiscard]] SurfaceMesh surface() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
