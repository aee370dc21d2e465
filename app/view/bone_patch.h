/// app/view/bone_patch.h: the surface of bone in a box as triangles that effects colour: the 0.5 level of the density, moved outwards a little, so
/// that it covers the bone that is drawn.
///   Frame  voxels in index coordinates; the mesh in the bone frame.   Units  m unless stated.   Errors  none.   Thread  as stated.
///   Source  app/view/surface_nets.h on the lattice of the voxels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/tool/tool.h"

namespace burrhole {

/// Densities of a box of voxels in 8 bits, as pictures have them: the owner of the bone writes them in its steps.
class DensityBytes {
 public:
  /// Without bone at first. Allocates.
  explicit DensityBytes(const VoxelBox& box) : box_(box), bytes_(box.count(), 0) {}
  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// @param density [-] over `voxels`, i fastest; parts outside the box are ignored. Does not allocate.
  void set(const VoxelBox& voxels, std::span<const float> density) noexcept;
  /// Copies a part, i fastest. @pre box() contains it.
  void copy(const VoxelBox& part, std::vector<std::uint8_t>& out) const;

 private:
  VoxelBox box_;
  std::vector<std::uint8_t> bytes_;  // density x 255
};

/// A box of densities and how it is meshed.
struct BonePatch {
  VoxelBox box;
  std::span<const std::uint8_t> density;  ///< as DensityBytes, i fastest
  Affine bone_from_index;                 ///< [m]
  double lift = 0.25;                     ///< [voxels] by which the surface is moved outwards
};

inline constexpr std::size_t kMostPatchPoints = 1'500'000;  ///< of a lattice; a box with more voxels has a coarser one

/// @returns the surface, counter-clockwise from outside, open where the box ends. At most three quadrangles for each point of the lattice. Uses all
/// cores.
[[nodiscard]] TriangleMesh make_bone_patch(const BonePatch& patch);

}  // namespace burrhole
