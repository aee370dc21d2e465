/// volumes/read/skull_segment.h: labels the layers of the skull in a CT: outer table, diploe, inner table, and dura and brain below them.
///   Frame  bone frame.   Units  SI; values in HU.   Errors  bad_input: the scan is not in HU.   Thread  any, once created.
///   Source [PetersikEtAl03] sec. 3.1 has attributed voxels from semi-automatic segmentation by thresholds; the method here is our own:
///     1. Thresholds give air, soft tissue and bone. Connected components of the enclosed space give the inside of the skull (skull_cavity.h).
///     2. At each place of the outer surface, a column follows the inward normal to the cavity. Normals are averaged along the surface.
///     3. The values along a column are averaged with those of its neighbours: down from the outer surface, and up from the inner one.
///     4. The borders of the layers follow from this profile (layer_profile.h), and are averaged along the surface.
///     5. A voxel takes the layer of its depth in the columns around it.
///   Where most columns show no layers, as in a shell of one material, bone has one label.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/voxel/bone_model.h"
#include "volumes/read/scan.h"

namespace burrhole {

/// Keys of [volume] with layers = "segment".
struct SegmentOptions {
  double air = -400.0;      ///< [HU] below: air
  double least_dip = 0.05;  ///< [-] diploe below the tables, over the height of the tables above soft tissue, from which there are layers
  double least_table = 0.5e-3;   ///< [m] least thickness of a table
  double smoothing = 2.5e-3;     ///< [m] standard deviation of the averages along the surface
  double dura = 0.5e-3;          ///< [m] thickness of dura: the scan does not show it
  std::optional<double> blur{};  ///< [m] of the scanner, standard deviation; absent: from the slope of the outer edge, place by place
};

/// Median and quartiles over the columns.
struct LayerSpread {
  double low = 0.0, median = 0.0, high = 0.0;  ///< [m]
};

struct SegmentFacts {
  int layers = 1;              ///< 3: outer table, diploe, inner table; 1: bone without layers; 0: no skull was found
  std::size_t columns = 0;     ///< on the outer surface of the skull
  double layered_share = 0.0;  ///< [-] of the columns
  LayerSpread thickness, outer_table, diploe, inner_table, blur;  ///< of the columns with layers; the thickness of all
  double dip = 0.0;                                               ///< [-] median of all columns
  double table = 0.0, marrow = 0.0;                               ///< [HU] medians of the tables and of diploe, without the blur
  double air = 0.0, soft = 0.0, bone = 0.0, cavity = 0.0;         ///< [m^3] of the scan
};

/// @returns the facts in one line, for the report and the notes of the bone.
[[nodiscard]] std::string segment_text(const SegmentFacts& facts);

class SkullSegment {
 public:
  /// @param hu_offset converts the values of the scan to HU. @param surface [HU] from which a voxel is bone. @pre `scan` outlives the result.
  [[nodiscard]] static SkullSegment find(const Scan& scan, double hu_offset, double surface, const SegmentOptions& options);

  /// @param is_bone the voxel is bone. @returns `none` for air and for what is more than a few millimetres away from the skull.
  [[nodiscard]] VoxelLabel label(const Vec3& p_bone, bool is_bone) const noexcept;
  [[nodiscard]] const SegmentFacts& facts() const noexcept { return facts_; }

  /// A place of the outer surface.
  struct Column {
    Vec3 entry{0.0}, inward{0.0};  ///< [m], [-] unit
    double thickness = 0.0;        ///< [m] to the inner surface
    double outer = 0.0;            ///< [m] thickness of the outer table as labelled, from the outer surface of the bone
    double inner = 0.0;            ///< [m] of the inner table, from its inner surface
    double layered = 0.0;          ///< [-] share of the columns around it with layers
  };
  [[nodiscard]] const std::vector<Column>& columns() const noexcept { return columns_; }

 private:
  static constexpr int kBlock = 8;  // [cells] edge of a block
  using Block = std::vector<std::int32_t>;
  SkullSegment() = default;
  void place_columns();
  [[nodiscard]] std::int32_t column_at(const Vec3i& cell) const noexcept;
  [[nodiscard]] VoxelLabel label_outside(const Vec3& p_bone, double depth, double thickness) const noexcept;

  const Scan* scan_ = nullptr;
  double hu_offset_ = 0.0;
  Affine scan_from_bone_;
  SegmentOptions options_;
  SegmentFacts facts_;
  std::vector<Column> columns_;
  Vec3 origin_{0.0};  // [m] of the cells
  Vec3i blocks_size_{0};
  std::vector<std::unique_ptr<Block>> blocks_;
};

}  // namespace burrhole
