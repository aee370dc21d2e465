/// core/mesh/mesh_patch.h: the ball pivoting mesh of the master window as a patch of triangles that contact reads.
///   Method  The mesh covers the window and follows its changed boxes. Its vertices are at the 0.5 surface. Triangles with a voxel in the
///     two outermost layers of the window are left out: the window ends there, not bone.
///   Result  The patch depends on box and density of the window only, not on the order of changes.
///   Cost    of a move of the window: a full pivoting; of a change: as BallMesh::update(), and the blocks of changed triangles.
///   Frame  bone, as TrianglePatch.   Units  SI.   Errors  none.   Thread  simulation.   Source  [TellesONeill10] section 4.2.
#pragma once

#include <optional>

#include "core/mesh/ball_mesh.h"
#include "core/voxel/triangle_patch.h"

namespace burrhole {

class MeshPatch final : public TriangleSource {
 public:
  explicit MeshPatch(const Affine& bone_from_index);
  void rebuild(const MasterWindow& window) override;
  void update(const MasterWindow& window, const VoxelBox& changed) override;
  void bring_up_to_date(TrianglePatch& copy) const override;
  [[nodiscard]] std::size_t bytes() const noexcept override;
  [[nodiscard]] const TrianglePatch& patch() const noexcept { return patch_; }
  [[nodiscard]] const BallMesh& mesh() const noexcept { return *mesh_; }  ///< @pre after rebuild()

 private:
  using Id = HalfEdgeMesh::Id;
  struct Corners;
  [[nodiscard]] Corners corners_of(Id triangle) const noexcept;
  [[nodiscard]] PatchTriangle shape_of(const Corners& corners) const noexcept;
  void lay_out(const VoxelBox& box);
  /// Moves a triangle to the block where it belongs now.
  void file(Id triangle);
  void touch(std::uint32_t block);
  void rebuild_touched();
  void rebuild_block(std::uint32_t block);
  void find_near(const MasterWindow& window, const VoxelBox& blocks);

  Affine bone_from_index_;
  bool turns_over_;  // the map mirrors
  std::optional<BallMesh> mesh_;
  TrianglePatch patch_;
  std::vector<std::vector<Id>> filed_;    // triangles of each block
  std::vector<std::uint32_t> block_of_;   // of each triangle; kNone
  std::vector<std::uint64_t> stamps_;     // of each block: TrianglePatch::stamp of its last change
  std::vector<std::uint32_t> touched_;    // blocks to be rebuilt
  std::vector<std::uint8_t> is_touched_;  // of each block
  std::vector<Id> changed_;
};

/// As MakeTriangles.
[[nodiscard]] std::unique_ptr<TriangleSource> make_mesh_patch(const Affine& bone_from_index);
/// @returns the expected memory of a source over a window, and of a number of copies of its patch [bytes].
[[nodiscard]] std::size_t mesh_patch_bytes(std::size_t window_voxels, std::size_t copies) noexcept;

}  // namespace burrhole
