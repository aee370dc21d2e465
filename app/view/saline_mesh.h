/// app/view/saline_mesh.h: bone that saline wets, in pictures: its surface within a ball round the tip and not below it, darker than dry bone and
/// with the gloss of water, which ripples.
///   What is wet is what Cooling (core/heat/heat_field.h) says. The film has no thickness and does not run.
///   Frame  bone frame unless stated.   Units  m.   Errors  none.   Thread  as PictureSource; set_bone() and set_film() as the steps.
///   Source  own; colour and gloss are chosen by eye, the place is not.
#pragma once

#include <vector>

#include "app/view/added_mesh.h"
#include "app/view/bone_patch.h"

namespace burrhole {

/// Where saline wets bone; reach 0: nowhere.
struct SalineFilm {
  Vec3 tip{0.0};           ///< [m]
  Vec3 up{0.0, 0.0, 1.0};  ///< [-] unit, along the shaft
  double reach = 0.0;      ///< [m] from the tip
  double below = 0.0;      ///< [m] below the tip, along `up`, to which bone is wet
};
/// @returns by how much [m] a point is inside the wet place; negative outside.
[[nodiscard]] double inside_film(const SalineFilm& film, const Vec3& p) noexcept;

class SalinePicture final : public PictureSource {
 public:
  /// @param voxels in which bone is shown wet, inside the bone. @param colors of dry bone over them, i fastest.
  SalinePicture(const VoxelBox& voxels, std::vector<Rgba8> colors, const Affine& bone_from_index);
  /// Bone changed. @param density [-] over `voxels`, i fastest. Does not allocate.
  void set_bone(const VoxelBox& voxels, std::span<const float> density) noexcept {
    density_.set(voxels, density);
    bone_moved_ = true;
  }
  void set_film(const SalineFilm& film) noexcept { film_ = film; }
  [[nodiscard]] bool copy_for_picture(bool exactly) override;
  void append_mesh(AddedMesh& out) const override;
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t voxels) noexcept { return voxels * (2 + sizeof(Rgba8)); }

 private:
  [[nodiscard]] Rgba8 wet_color(const Vec3& p) const noexcept;

  DensityBytes density_;
  std::vector<Rgba8> colors_;
  Affine bone_from_index_, index_from_bone_;
  SalineFilm film_, shown_;
  VoxelBox box_;                      // of the last copy
  std::vector<std::uint8_t> copied_;  // densities in it
  bool bone_moved_ = true, first_ = true;
};

}  // namespace burrhole
