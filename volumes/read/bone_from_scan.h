/// volumes/read/bone_from_scan.h: from the numbers of a scan to the two fields of bone: occupancy (is it bone?) and hardness.
///   Frame      bone frame (LPS).   Units SI; values of the scan in HU, or as the file has them.   Thread any.
///   Occupancy  0.5 + (v - m) / (2 b), clamped to 0..1: m the middle of the band, b the larger of half the band and the sum over the index
///              axes of the larger of the two steps to the next voxel. Where a scan steps over the band within a voxel, as most do, a ramp
///              of the band alone would put the 0.5 level half way between the voxels; widened so, trilinear interpolation has it where the
///              scan's own trilinear interpolation passes m. Own derivation.
///   Hardness   (rho - 1100) / 800 clamped to 0..1, rho [kg/m3] from HU by the piecewise line of k-Wave's hounsfield2density; or a table.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/voxel/bone_model.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// Most voxels of a resampled grid: as many as a phantom may have.
inline constexpr double kMaxResampledVoxels = 300e6;

/// A corner of a piecewise linear table; values before the first and after the last keep its hardness.
struct HardnessPoint {
  double value = 0.0;     ///< [HU] or the file's own unit
  double hardness = 0.0;  ///< 0..1
};

/// Box in the bone frame.
struct BoneRegion {
  Vec3 centre{0.0};  ///< [m]
  Vec3 size{0.0};    ///< [m]
};

struct BoneOptions {
  std::optional<std::array<double, 2>>
      band;                             ///< from no bone to bone, in HU or, if the scan is not in HU, its own unit; absent: 250, 400 HU
  std::vector<HardnessPoint> hardness;  ///< sorted by value; empty: by density
  std::optional<double> hu_offset;      ///< added to each value; absent: found out (HU + 1024 scans are common)
  std::optional<double> spacing;        ///< [m] resample to this isotropic pitch; absent: voxels as they are
  std::optional<BoneRegion> region;     ///< keep this box only; needs `spacing`
};

/// CT density of [k-Wave], kg/m3, never negative. facts: h = HU + 1000, four lines.
[[nodiscard]] double density_of_hounsfield(double hu) noexcept;
/// Hardness of that density: 0 at 1100 kg/m3, 1 at 1900 (assumption).
[[nodiscard]] double hardness_of_hounsfield(double hu) noexcept;
[[nodiscard]] double hardness_of_table(const std::vector<HardnessPoint>& table, double value) noexcept;

/// The grid a bone will have, known before it is made.
struct BoneGrid {
  Vec3i dims{0};
  Affine bone_from_index;
  bool resampled = false;
};

/// @returns bad_input: a band that does not increase, a region without a spacing.
[[nodiscard]] Status check_options(const BoneOptions& options);

/// Box round the centres of some voxels: lowest and highest corner, bone frame [m].
[[nodiscard]] std::array<Vec3, 2> bounds_of(const VoxelBox& box, const Affine& bone_from_index);

/// @returns the scan's own grid, or the isotropic one in the bone frame that options ask for; bad_input if it passes kMaxResampledVoxels or
/// the region misses the scan, with the numbers.
[[nodiscard]] Result<BoneGrid> plan_grid(const Scan& scan, const BoneOptions& options);

struct BoneFromScan {
  std::shared_ptr<const BoneModel> bone;
  bool has_values = false;                  ///< the scan has values that mean density, not occupancy
  double value_min = 0.0, value_max = 0.0;  ///< of the scan, offset applied
  double hu_offset = 0.0;
  bool hounsfield = false;  ///< values are taken as HU
};

/// @param assumed gets one line for each thing taken for granted. @returns bad_input: values that are no HU and no band given, a band that
/// is not increasing, no bone in the band (with the range found). Works in slabs: beside the scan it needs the bone's own grids
/// and about 120 bytes a voxel of one layer.
/// `before` is called when the grid is known and before it takes memory; may be empty.
[[nodiscard]] Result<BoneFromScan> make_bone(const Scan& scan, const BoneOptions& options, std::vector<std::string>& assumed,
                                             const std::function<void(const BoneGrid&)>& before = {});

}  // namespace burrhole
