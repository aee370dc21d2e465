/// volumes/read/label_volume.h: labels of the user for the voxels of a scan, from a file of any format that read_scan() reads.
///   Names  of a .seg.nrrd of 3D Slicer: its fields SegmentN_LabelValue, SegmentN_Name, SegmentN_Color; or a label description file of
///          ITK-SNAP: lines IDX R G B A VIS MSH "LABEL". A name of a layer ("outer table", "diploe", "inner table", "dura", "brain",
///          "forbidden", in any case) gives the voxels that layer's own label.
///   Frame  bone frame.   Units  SI.   Errors  bad_input with the path as place.   Thread  any.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/voxel/label_table.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/scan.h"

namespace burrhole {

struct LabelVolume {
  Vec3i dims{0};
  Affine index_from_bone;
  std::vector<std::uint8_t> values;  ///< VoxelLabel; 0: the file has no label there
  LabelTable table;

  /// @returns the label of the nearest voxel; `none` outside.
  [[nodiscard]] VoxelLabel at(const Vec3& p_bone) const noexcept;
};

/// @returns the labels; bad_input: another grid than that of the scan, values that are no whole numbers of at least 0, more than 240 of them,
/// an invalid table, or no label at all.
[[nodiscard]] Result<LabelVolume> read_label_volume(const LabelFiles& files, const Scan& scan);

/// A row of a table of names.
struct LabelRow {
  int value = 0;  ///< [-] of the voxels
  std::string name;
  LabelColor color{};
};
/// @param path for messages. @returns bad_input with the place `path:line`.
[[nodiscard]] Result<std::vector<LabelRow>> parse_label_table(const std::string& text, const std::string& path);
/// @returns the segments of the header of a .seg.nrrd; none if it has no such fields.
[[nodiscard]] std::vector<LabelRow> parse_segments(const std::string& header);

}  // namespace burrhole
