/// app/view/bone_mesh.h: the surface that a display draws as triangles: the 0.5 level of the drawn field, meshed by core/mesh and kept up to date
/// by the same texels that a texture would get.
///   Frame   bone frame; voxels in index coordinates of the volume.   Units  m unless stated.   Errors  out_of_range: the volume is too long.
///   Number  triangles have stable numbers; a number without a triangle has three equal vertices, so that nothing is drawn of it.
///   Thread  one owner, that of the display.   Source  core/mesh/ball_mesh.h; normals: own derivation, from the gradient at the vertex.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "app/view/view.h"
#include "core/base/bounds.h"
#include "core/base/result.h"
#include "core/mesh/ball_mesh.h"

namespace burrhole {

/// A corner of a triangle, as a display gets it.
struct MeshVertex {
  Vec3f position{0.0f};                  ///< [m]
  std::array<std::int16_t, 4> normal{};  ///< [-] outward, times 32767; the fourth is 32767 where textures of bone apply, otherwise 0
  Rgba8 color;                           ///< of the voxel; a: 255 where bone was cut, 0 on the surface as loaded
  friend bool operator==(const MeshVertex&, const MeshVertex&) = default;
};
static_assert(sizeof(MeshVertex) == 24);
using MeshTriangle = std::array<MeshVertex, 3>;

/// Numbers of triangles, half-open.
struct TriangleRange {
  std::uint32_t begin = 0, end = 0;
  [[nodiscard]] std::uint32_t size() const noexcept { return end - begin; }
  friend bool operator==(const TriangleRange&, const TriangleRange&) = default;
};

struct BoneMeshOptions {
  bool labels = true;      ///< colours of the voxels; false: one ivory colour
  bool find_cuts = false;  ///< the vertices know what was cut: the volume's tissue has the bone as loaded, without it the volume is that
};

class BoneMesh {
 public:
  /// Meshes a volume; a detail of it is left out. @returns out_of_range if an edge is longer than BallMesh::kLongestBox voxels.
  [[nodiscard]] static Result<BoneMesh> create(const VolumeView& volume, const BoneMeshOptions& options = {});

  /// Follows a change. @pre the volume contains the box, and the texels are not those of a detail.
  void update(const TexelBox& texels);
  /// @returns the triangles that differ from those at the last call, increasing, adjacent ones in one range; at first all.
  [[nodiscard]] std::vector<TriangleRange> take_changed();
  /// @returns a triangle, counter-clockwise seen from outside. @pre number < slots().
  [[nodiscard]] MeshTriangle triangle(std::uint32_t number) const;
  [[nodiscard]] std::uint32_t slots() const noexcept { return mesh_.half_edges().triangle_slots(); }
  [[nodiscard]] std::size_t triangles() const noexcept { return mesh_.half_edges().triangles(); }

  [[nodiscard]] const Vec3i& dims() const noexcept { return dims_; }
  [[nodiscard]] const Affine& bone_from_index() const noexcept { return bone_from_index_; }
  /// @returns the colour of each voxel, i fastest, for a section.
  [[nodiscard]] const std::vector<Rgba8>& colors() const noexcept { return colors_; }
  /// @returns the share of bone of each voxel of a box, i fastest, 0..1, as VolumeTexture::read_mineral() without tissue. @pre the volume
  /// contains the box.
  [[nodiscard]] std::vector<float> read_mineral(const VoxelBox& box) const;
  /// @returns the box [m] of the bone as loaded, bone frame; that of the volume without BoneMeshOptions::find_cuts.
  [[nodiscard]] Bounds loaded_box() const;
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  BoneMesh(BallMesh mesh, const VolumeView& volume, const BoneMeshOptions& options);
  [[nodiscard]] DensityBlock block() const noexcept { return {mesh_.box(), density_}; }
  [[nodiscard]] MeshVertex corner(std::uint32_t half_edge, const Vec3& face) const;
  [[nodiscard]] std::uint8_t cut_at(const Vec3& p, const Vec3& falling) const;
  [[nodiscard]] bool is_textured(std::size_t voxel) const noexcept;

  BallMesh mesh_;
  Vec3i dims_;
  Affine bone_from_index_;
  Mat3 bone_from_gradient_;
  bool turns_over_;             // the index axes are left-handed in the bone frame
  std::vector<float> density_;  // [-] of the drawn field
  std::vector<std::uint8_t> bone_;
  std::vector<std::uint8_t> loaded_;  // the same as loaded; empty unless cuts are found
  std::vector<Rgba8> colors_;
  std::vector<std::uint32_t> changed_;  // reused memory
};

/// @returns the predicted memory [bytes] of a mesh of a volume, with the copy that a driver in memory holds. @param voxels of the volume. @param
/// find_cuts as in BoneMeshOptions.
[[nodiscard]] std::uint64_t mesh_bytes(std::uint64_t voxels, bool find_cuts = false) noexcept;

}  // namespace burrhole
