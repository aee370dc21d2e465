/// app/view/heat_mesh.h: the temperature of bone in pictures: its surface, coloured by what a HeatField holds, where it is above a limit.
///   Colour  that of core/base/color_ramp.h at the place on a scale: of temperatures linear, of the dose logarithmic. A vertex has the mean of the
///           places of the eight cells round it, weighted trilinearly and by their share of bone, so it lies between the least and the largest of
///           them; cells without bone do not count. The edge of the patch is the isotherm of the scale's lower end.
///   Frame  bone frame; cells as HeatField.   Units  SI; degrees Celsius; dose [min].   Errors  none.
///   Thread  as PictureSource; set_bone() as the steps.   Source  own derivation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/view/added_mesh.h"
#include "app/view/bone_patch.h"
#include "app/view/color_bar.h"
#include "core/heat/bone_cells.h"
#include "core/heat/heat_field.h"

namespace burrhole {

enum class HeatQuantity { temperature, peak, dose };

/// [heat.picture]
struct HeatPictureConfig {
  HeatQuantity quantity = HeatQuantity::temperature;
  double lowest = 40.0;       ///< [C] below it bone is drawn as bone (an assumption)
  double highest = 60.0;      ///< [C] from it on the colour does not change (an assumption)
  double damage_dose = 16.0;  ///< [min] of [heat]; the scale of the dose is from it over kDoseSpan to it times kDoseSpan
};
inline constexpr double kDoseSpan = 16.0;
/// AddedMesh::unlit of a colour, 80 %: in full shade it is read within a tenth of the scale, and the rest still shows the shape. Without it a colour
/// in full shade is read up to 0.9 of the scale too low.
inline constexpr std::uint8_t kHeatUnlit = 204;

/// @returns the place on the scale of a temperature [C] or a dose [min]: 0 at its lower end, 1 at its upper one, beyond them outside of 0..1.
[[nodiscard]] double place_on_scale(const HeatPictureConfig& config, double value) noexcept;
/// @returns the scale as a picture shows it.
[[nodiscard]] ColorBar color_bar(const HeatPictureConfig& config);

/// What a picture shows, copied from a HeatField.
struct HeatCopy {
  VoxelBox cells;                     ///< round those that are on the scale; empty: nothing is drawn
  std::vector<float> place;           ///< [-] on the scale, of each cell, i fastest
  std::vector<float> share;           ///< [-] of bone; 0 where a cell holds no heat
  VoxelBox voxels;                    ///< of the cells
  std::vector<std::uint8_t> density;  ///< of the voxels, as DensityBytes
};

class HeatPicture final : public PictureSource {
 public:
  /// @param field must outlive this. @param voxels that set_bone() may name.
  HeatPicture(const HeatField& field, const BoneCells& cells, const VoxelBox& voxels, const Affine& bone_from_index, double body,
              const HeatPictureConfig& config);
  /// Bone changed. @param density [-] over `voxels`, i fastest. Does not allocate.
  void set_bone(const VoxelBox& voxels, std::span<const float> density) noexcept {
    density_.set(voxels, density);
    bone_moved_ = true;
  }
  [[nodiscard]] bool copy_for_picture(bool exactly) override;
  void append_mesh(AddedMesh& out) const override;
  [[nodiscard]] const HeatCopy& shown() const noexcept { return shown_; }
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t cells, std::uint64_t voxels) noexcept {
    return 2 * cells * 2 * sizeof(float) + 3 * voxels;
  }

 private:
  [[nodiscard]] double place(const Vec3i& cell) const noexcept;
  [[nodiscard]] VoxelBox cells_on_scale() const noexcept;
  [[nodiscard]] bool differs(bool exactly) const noexcept;

  const HeatField* field_;
  BoneCells cells_;
  Affine bone_from_index_;
  double body_;  // [C]
  HeatPictureConfig config_;
  DensityBytes density_;
  HeatCopy shown_, next_;
  bool bone_moved_ = false, copied_ = false;
};

/// @returns the place on the scale at a point of index coordinates; nothing where no cell beside it holds heat.
[[nodiscard]] std::optional<double> place_at(const HeatCopy& copy, const BoneCells& cells, const Vec3& index) noexcept;
/// Appends the triangles.
void append_heat(const HeatCopy& copy, const BoneCells& cells, const Affine& bone_from_index, AddedMesh& out);

}  // namespace burrhole
