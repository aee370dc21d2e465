/// volumes/read/markups.h: a planned line, entry and target, from a markups file of 3D Slicer (.mrk.json or .fcsv).
///   Frame   bone frame (LPS), from LPS or RAS.   Units  m, from mm or um.   Errors  bad_input with "file:line:column".
///   Source  markups-schema-v1.0.3.json and vtkMRMLMarkupsFiducialStorageNode of 3D Slicer 5.
#pragma once

#include <string>
#include <string_view>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct PlannedLine {
  Vec3 entry{0.0};   ///< [m]
  Vec3 target{0.0};  ///< [m] at least 0.1 mm from the entry
};

/// The two points of a line, or of a list with two points: entry, then target. Points labelled "entry" and "target", in any case, are
/// preferred, in any order and beside others. A file with several markups must have exactly one line.
/// @param name of the file, for messages.
[[nodiscard]] Result<PlannedLine> parse_markups_json(std::string_view text, const std::string& name);
/// The same for a list of points as comma-separated values. Without a line "CoordinateSystem" the points are RAS, as 3D Slicer reads them.
[[nodiscard]] Result<PlannedLine> parse_markups_fcsv(std::string_view text, const std::string& name);
/// Reads a file by its ending, .json or .fcsv. bad_input: another ending; missing, or larger than 16 MB.
[[nodiscard]] Result<PlannedLine> read_planned_line(const std::string& path);

}  // namespace burrhole
