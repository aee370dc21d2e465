/// tests/core/drill/subvoxel_cases.h: sub-voxel removal by balls and cylinders whose swept solid has a closed form.
#pragma once

#include "core/tool/cutting_field.h"
#include "tests/core/drill/swept_solid.h"

namespace burrhole::test {

inline constexpr float kAtOnce = 1e12f;  ///< [1/rev] a factor that clears at once what it may clear

/// The exact cutting field of a SweptSolid's tool, one factor [1/rev] everywhere.
[[nodiscard]] std::shared_ptr<const CuttingField> field_of(const SweptSolid& solid, float factor);
/// The tool's erosion with sub-voxel removal (or as `config` says).
[[nodiscard]] Erosion subvoxel_erosion(const SweptSolid& solid, float factor, ErosionConfig config = {.subvoxel = true});

struct SolidCase {
  bool ball = true;
  double radius = 4.0;  ///< [voxels]
  double way = 6.0;     ///< [voxels]
  std::uint64_t seed = 1;
};
/// A tool with a random pose and offset on a random way, in the middle of a block that `block_for` makes; the cylinder is as high as wide.
[[nodiscard]] SweptSolid random_solid(const SolidCase& one);
[[nodiscard]] Voxmap block_for(const SolidCase& one);
/// Drives the tool along its way in that many steps at spin 1. @returns the removed volume [voxels^3].
double sweep_through(Voxmap& voxmap, Erosion& erosion, const SweptSolid& solid, int steps);

/// Density between voxel centres, trilinear.
[[nodiscard]] double density_at(const MasterWindow& window, const Vec3& p);
/// Direction in which density rises, by differences of half a voxel of the above; length 1.
[[nodiscard]] Vec3 rise_at(const MasterWindow& window, const Vec3& p);
/// Volume with density below 0.5 [voxels^3], 8^3 places a cell, over the window but for its rim.
[[nodiscard]] double hollow(const MasterWindow& window);
/// How far along `outward` from p the density first passes 0.5 [voxels], sought within +-2; NaN if it does not.
[[nodiscard]] double surface_offset(const MasterWindow& window, const Vec3& p, const Vec3& outward);

}  // namespace burrhole::test
