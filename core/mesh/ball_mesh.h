/// core/mesh/ball_mesh.h: the surface of bone as triangles on voxel centres, by ball pivoting, kept up to date while bone is removed.
///   Method   A voxel is solid if its density is at least 0.5. A ball of kBallRadius that has no solid centre inside rests on three of them:
///     a triangle. From each edge it rolls on to the next three. Removal of a voxel takes away the triangles that have it as a vertex; a
///     front loop bounds the hole, and the ball rolls on from there. Growth takes away the triangles whose ball would contain the voxel.
///   Result   After resume() the triangles are all those on which an empty ball rests, whatever the order of changes: a full pivoting finds
///     the same ones. Every edge has a partner: there is no border. Bone that ends at the box is closed there.
///   Cost     of an update: the changed box, and per voxel that crosses 0.5 the eight cells round it.
///   Frame  index; triangles are counter-clockwise from outside bone.   Units  voxels.   Errors  out_of_range.
///   Thread  one owner; it reads the density of the simulation, so it is called where that is not written.
///   Source  [TellesONeill10] section 3 (dynamic ball pivoting); the grid's tables and the proof: docs/mesh.md, own derivation.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/ball_tables.h"
#include "core/mesh/half_edge_mesh.h"
#include "core/mesh/solid_bits.h"
#include "core/mesh/vertex_map.h"
#include "core/tool/surface_mesh.h"
#include "core/voxel/gradient.h"

namespace burrhole {

struct BallMeshConfig {
  bool subvoxel = false;  ///< vertices are moved from the centres to the 0.5 surface, by offset_to_surface()
  bool report = false;    ///< changed triangles are listed, see take_changed()
};

/// Work since the mesh was created.
struct MeshWork {
  std::uint64_t voxels_removed = 0, voxels_added = 0;
  std::uint64_t triangles_added = 0, triangles_removed = 0;
  std::uint64_t pivots = 0;          ///< edges over which the ball rolled
  std::uint64_t glued = 0;           ///< of those, that reached a known triangle; the others joined a new one
  std::uint64_t seeds = 0;           ///< triangles where the ball was put down
  std::uint64_t vertices_moved = 0;  ///< offsets that were computed

  [[nodiscard]] std::uint64_t triangles_touched() const noexcept { return triangles_added + triangles_removed; }
};

/// An edge over which the ball has still to roll.
struct FrontEdge {
  Vec3i from{0}, to{0};  ///< [voxels] counter-clockwise in its triangle
  Vec3i opposite{0};     ///< [voxels] third vertex of its triangle
  Vec3 ball{0.0};        ///< [voxels] centre of the ball on the triangle
};

struct PivotRules;

class BallMesh {
 public:
  static constexpr int kLongestBox = 1024;  ///< [voxels]

  /// Empty bone. out_of_range: the box is empty or an edge of it is longer than kLongestBox.
  [[nodiscard]] static Result<BallMesh> create(const VoxelBox& box, const BallMeshConfig& config = {});

  /// Full pivoting. @pre block.box contains box().
  void fill(const DensityBlock& block);
  /// Brings the mesh up to date after the density changed in `changed`, which may extend outside box(). @pre as fill().
  void update(const DensityBlock& block, const VoxelBox& changed);

  /// The steps of an update: any number of these, then resume(). A voxel that is already so is no change. @pre voxel in box().
  void remove(const Vec3i& voxel);
  void add(const Vec3i& voxel);
  /// Rolls the ball until no front is left, and puts it down wherever a triangle is missing near a changed voxel.
  void resume();

  /// Appends to `out` the numbers of the triangles that were added, removed or moved since the last call, increasing, each once. After
  /// fill(): all. A number that is no triangle any more is one to be removed. Their order does not depend on that of the changes.
  /// Without `report` nothing is listed.
  void take_changed(std::vector<HalfEdgeMesh::Id>& out);
  /// Lists the triangles of all vertices in a box as changed, for a reader whose data of a vertex depend on more than its position.
  void list_vertices(const VoxelBox& part);

  [[nodiscard]] const VoxelBox& box() const noexcept { return solid_.box(); }
  [[nodiscard]] const MeshWork& work() const noexcept { return work_; }
  [[nodiscard]] const HalfEdgeMesh& half_edges() const noexcept { return mesh_; }
  /// @pre voxel in box().grown(1), outside of which all are empty.
  [[nodiscard]] bool is_solid(const Vec3i& voxel) const noexcept { return solid_.at(solid_.index_of(voxel)); }
  /// @returns whether a voxel is solid and one of its six face neighbours is not. Only such voxels can be vertices. @pre voxel in box().
  [[nodiscard]] bool is_surface(const Vec3i& voxel) const noexcept;
  /// @returns orphan also for voxels that are not surface voxels. @pre voxel in box().
  [[nodiscard]] HalfEdgeMesh::VertexState state(const Vec3i& voxel) const noexcept;
  [[nodiscard]] FrontEdge front_edge(HalfEdgeMesh::Id half_edge) const noexcept;

  /// @returns the offset [voxels] of the corner of a triangle at which a half-edge begins, from the voxel's centre to the 0.5 surface; the same
  /// for all triangles of a fan. Along the falling gradient; where a voxel has several fans, as in a wall of one voxel, along the mean normal
  /// of each. Zero without `subvoxel`, before update() has seen the triangle, and where no surface is found.
  [[nodiscard]] Vec3f offset(HalfEdgeMesh::Id half_edge) const noexcept {
    return half_edge < offsets_.size() ? offsets_[half_edge] : Vec3f(0.0f);
  }
  /// @returns the position [voxels] of that corner.
  [[nodiscard]] Vec3 position(HalfEdgeMesh::Id half_edge) const noexcept {
    return Vec3(mesh_.voxel(mesh_.origin(half_edge))) + Vec3(offset(half_edge));
  }
  /// @returns the mesh as two arrays, in index coordinates. With `subvoxel` each fan has a vertex of its own. Allocates.
  [[nodiscard]] SurfaceMesh surface() const;
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  using Id = HalfEdgeMesh::Id;
  friend Result<BallMesh> make_sabotaged_mesh(const VoxelBox& box, const BallMeshConfig& config, const PivotRules& rules);  // pivot_rules.h
  BallMesh(const VoxelBox& box, const BallMeshConfig& config, TieRule tie);

  void list(Id triangle);
  void mark_cells(std::size_t index);
  void part_across(const Vec3i& voxel);
  void roll(Id half_edge);
  [[nodiscard]] unsigned reached(const Vec3i& from, unsigned edge, unsigned opposite) const noexcept;
  [[nodiscard]] bool put_down();
  Id add_triangle(const std::array<Id, 3>& vertices);
  void remove_triangle(Id triangle);
  [[nodiscard]] Id vertex_at(const Vec3i& voxel);
  [[nodiscard]] std::optional<Id> find_triangle(std::size_t cell, const CellTriangle& corners) const noexcept;
  void move_vertices(const DensityBlock& block, const VoxelBox& part);
  void move_fans(const DensityBlock& block, Id vertex);
  void move_fan(Id half_edge, const std::optional<Vec3>& offset);
  template <class F>
  void for_each_in_fan(Id half_edge, F&& f) const;

  BallMeshConfig config_;
  std::shared_ptr<const BallTables> tables_;
  SolidBits solid_;
  HalfEdgeMesh mesh_;
  VertexMap vertices_;
  std::vector<Vec3f> offsets_;              // [voxels] per half-edge; empty without subvoxel
  std::vector<Id> fans_;                    // of one vertex: half-edges of fans that have been moved
  std::vector<std::size_t> changed_cells_;  // by the index of the lowest corner
  std::vector<std::uint64_t> is_marked_;    // one bit per index: in changed_cells_
  std::vector<Id> doomed_;                  // of one removal
  std::vector<Id> changed_;                 // triangles; empty without report
  std::vector<std::uint64_t> is_listed_;    // one bit per triangle: in changed_
  MeshWork work_;
  std::uint64_t missed_glue_ = 0;  // 0; pivot_rules.h
};

}  // namespace burrhole
