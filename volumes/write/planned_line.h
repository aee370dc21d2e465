/// volumes/write/planned_line.h: writes a planned line as a markups file of 3D Slicer.
///   Frame  LPS or RAS in the file, which names it; LPS in.   Units  mm in the file.   Errors  bad_input with the path as place.
///   Source  markups-schema-v1.0.3.json and vtkMRMLMarkupsFiducialStorageNode of 3D Slicer 5.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "volumes/read/markups.h"

namespace burrhole {

enum class MarkupsFrame : std::uint8_t { lps, ras };

/// A line of two control points, "entry" and "target" (.mrk.json).
[[nodiscard]] std::string markups_json(const PlannedLine& line, MarkupsFrame frame = MarkupsFrame::lps);
/// A list of the same two points (.fcsv).
[[nodiscard]] std::string markups_fcsv(const PlannedLine& line, MarkupsFrame frame = MarkupsFrame::lps);
/// @returns whether the path ends in .mrk.json or .fcsv.
[[nodiscard]] bool is_markups_path(const std::string& path);
/// Writes the format of the path's ending, in LPS. @pre is_markups_path(path).
[[nodiscard]] Status write_planned_line(const std::string& path, const PlannedLine& line);

}  // namespace burrhole
