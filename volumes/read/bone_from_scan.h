/// volumes/read/bone_from_scan.h: computes the two fields of bone, occupancy and hardness, from the values of a scan.
///   Frame      bone frame (LPS).   Units SI; values of the scan in HU or in the unit of the file.   Errors bad_input, unavailable.
///   Thread     any.
///   Occupancy  0.5 + (v - m) / (2 b), clamped to 0..1: m the middle of the band, b the larger of half the band and the sum over the index
///              axes of the larger of the two steps to the next voxel. Most scans pass the whole band within a voxel; a ramp of the band
///              alone would then place the 0.5 level half way between the voxels. With b, trilinear interpolation of occupancy has its 0.5
///              level where trilinear interpolation of the scan is m. Own derivation.
///   Hardness   (rho - 1100) / 800 clamped to 0..1, rho [kg/m3] from HU by the piecewise linear hounsfield2density of k-Wave; or a table.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/bounds.h"
#include "core/voxel/bone_model.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// [voxels] Largest resampled grid: a body at 0.25 mm. Only blocks with bone take memory.
inline constexpr double kMaxResampledVoxels = 8e9;

/// A point of a piecewise linear table. Values outside the table take the hardness of its first or last point.
struct HardnessPoint {
  double value = 0.0;     ///< [HU] or [unit of the file]
  double hardness = 0.0;  ///< [-] 0..1
};

/// Box in the bone frame.
struct BoneRegion {
  Vec3 centre{0.0};  ///< [m]
  Vec3 size{0.0};    ///< [m]
};

/// Where the options of a bone were given, for the errors that they cause; empty: the error has the path of the scan.
struct BonePlaces {
  std::string band, spacing, region, labels, label_table;
};

struct SegmentOptions;  // skull_segment.h
struct SegmentFacts;    // skull_segment.h
struct LabelVolume;     // label_volume.h

/// A label volume of the user.
struct LabelFiles {
  std::string volume;  ///< path; empty: there is none
  std::string table;   ///< path of a label description file of ITK-SNAP; empty: names and colours of the volume itself
};

struct BoneOptions {
  std::optional<std::array<double, 2>>
      band;  ///< [HU] values without bone and of full bone; [unit of the file] if the scan is not in HU; absent: 250, 400 HU
  std::vector<HardnessPoint> hardness;  ///< sorted by value; empty: from density
  std::optional<double> hu_offset;      ///< [HU] added to each value; absent: detected (scans stored as HU + 1024 are common)
  std::optional<double> spacing;        ///< [m] isotropic pitch after resampling; absent: the voxels of the scan
  std::optional<BoneRegion> region;     ///< keeps this box only; needs `spacing`
  BonePlaces places{};
  std::shared_ptr<const SegmentOptions> segment{};  ///< the layers of the skull are labelled; null: bone has one label
  LabelFiles label_files{};                         ///< read by import_bone() into `labels`
  std::shared_ptr<const LabelVolume> labels{};      ///< replace the other labels where they are not 0; null: there are none
};

/// @returns the CT density [kg/m3] of [k-Wave], >= 0: four linear parts in h = HU + 1000.
[[nodiscard]] double density_of_hounsfield(double hu) noexcept;
/// @returns the hardness [-] of that density: 0 at 1100 kg/m3, 1 at 1900 kg/m3 (assumption).
[[nodiscard]] double hardness_of_hounsfield(double hu) noexcept;
[[nodiscard]] double hardness_of_table(const std::vector<HardnessPoint>& table, double value) noexcept;

/// The grid of the bone, known before it is made.
struct BoneGrid {
  Vec3i dims{0};  ///< [voxels]
  Affine bone_from_index;
  bool resampled = false;
  /// [-] Estimated share of the voxels that are in blocks with bone. Before the values are read: 1 for a region, 0 for a whole scan.
  double bone_share = 1.0;
  std::uint64_t loaded_bytes = 0;  ///< [bytes] of a bone model that is in memory already; 0: the bone is still to be made
};

/// Called when the grid of a bone is known, before the bone takes memory. @returns where the bone is to be kept; an error ends the work.
using ChooseStorage = std::function<Result<BoneStorage>(const BoneGrid&)>;

/// @returns bad_input if the band does not increase, or a region is given without a spacing.
[[nodiscard]] Status check_options(const BoneOptions& options);

/// Box round the centres of some voxels: lowest and highest corner, bone frame [m].
[[nodiscard]] Bounds bounds_of(const VoxelBox& box, const Affine& bone_from_index);

/// @returns the grid of the scan, or the isotropic grid in the bone frame that `options` request; bad_input, with the numbers, if it
/// exceeds kMaxResampledVoxels or the region does not meet the scan.
[[nodiscard]] Result<BoneGrid> plan_grid(const Scan& scan, const BoneOptions& options);

struct BoneFromScan {
  std::shared_ptr<const BoneModel> bone;
  bool has_values = false;                        ///< the values are densities, not occupancy
  double value_min = 0.0, value_max = 0.0;        ///< [HU] or [unit of the file] range of the scan, offset applied
  double hu_offset = 0.0;                         ///< [HU] offset that was applied
  bool hounsfield = false;                        ///< the values are interpreted as HU
  double surface = 0.5;                           ///< [unit of the scan's values] from which a voxel is bone: the middle of the band
  std::shared_ptr<const SegmentFacts> segment{};  ///< what was found of the layers, if they were asked for
};

/// @returns the memory [bytes] that make_bone() needs in addition to the scan and the bone: slabs of the grid, and refined slices. It reads no
/// values of the scan.
[[nodiscard]] std::uint64_t slab_bytes(const Scan& scan, const BoneGrid& grid) noexcept;

/// @returns what is to be added to the values of a scan to convert them to HU, as make_bone() finds it; bad_input if they are not HU.
[[nodiscard]] Result<double> find_hu_offset(const Scan& scan, const BoneOptions& options);

/// @param assumed receives one line per assumption. @param place may be empty: the bone is in memory. @returns bad_input: values that are not
/// HU without a band, a band that does not increase, no bone in the band (with the range of the values); unavailable: more bone than the
/// machine has memory for, or errors of bone_file.h. Works in slabs, see slab_bytes(). Uses all cores.
[[nodiscard]] Result<BoneFromScan> make_bone(const Scan& scan, const BoneOptions& options, std::vector<std::string>& assumed,
                                             const ChooseStorage& place = {});

}  // namespace burrhole
