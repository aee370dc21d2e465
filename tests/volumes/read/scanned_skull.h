/// tests/volumes/read/scanned_skull.h: a closed skull of three layers, scanned, with the truth of every layer.
///   Frame  bone frame, the centre of the skull at the origin.   Units  SI; HU.   Errors none.   Thread any.
#pragma once

#include <array>

#include "core/voxel/bone_model.h"
#include "tests/volumes/read/scanned_body.h"

namespace burrhole::test {

/// A ball of brain in three shells of bone, in soft tissue, in air.
struct Skull {
  double radius = 38e-3;                                               ///< [m] of the outer surface
  double outer_table = 2.4e-3, diploe = 2.9e-3, inner_table = 1.7e-3;  ///< [m] facts: 2.4 and 1.7 mm, 7.04 mm in all
  double skin = 5e-3;                                                  ///< [m]
  double table_hu = 1500.0, diploe_hu = 900.0, tissue_hu = 40.0, air_hu = -1000.0;

  [[nodiscard]] double thickness() const noexcept { return outer_table + diploe + inner_table; }
  /// Depths of the four borders of the layers below the outer surface.
  [[nodiscard]] std::array<double, 4> borders() const noexcept { return {0.0, outer_table, outer_table + diploe, thickness()}; }
  [[nodiscard]] VoxelLabel label(const Vec3& p_bone) const noexcept;
};

/// Isotropic Gaussian blur of the scanner, then the mean of each voxel over its box, from 2 x 2 x 4 points; then noise.
[[nodiscard]] Scan scan_skull(const Skull& skull, const Scanner& scanner);

}  // namespace burrhole::test
