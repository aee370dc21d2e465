/// app/bench/dicom_series.h: writes a long DICOM series from a short real one, to measure imports of the size of a whole head. The files of
/// the source are repeated in the order of their names. Each copy has a new position, 1 mm along z from the one before, and new instance
/// UIDs; all other bytes are those of the source.   Errors  bad_input.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Writes `slices` files into `folder`. @pre both folders exist. @returns the paths in the order of their positions; bad_input if the
/// source is empty, or if a file lacks these fields in explicit little-endian form or has no space for the new values.
[[nodiscard]] Result<std::vector<std::string>> write_long_series(const std::string& source_folder, const std::string& folder, int slices);

/// A simple reader of such files, as the baseline of the measurement. It takes the last 512 x 512 x 2 bytes of a file as pixels (16-bit
/// integers) and searches the bytes for the two fields. @returns the values [HU] of all files in order: slope x pixel + intercept;
/// bad_input if a file cannot be read or is too short.
[[nodiscard]] Result<std::vector<float>> read_plainly(const std::vector<std::string>& files);

}  // namespace burrhole
