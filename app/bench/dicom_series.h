/// app/bench/dicom_series.h: a long DICOM series from a short real one, to measure imports of the size of a whole head. It repeats the
/// slices at a distance of 1 mm with new positions and UIDs; all other bytes are equal.   Errors  bad_input.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Writes `slices` files into `folder`, which must exist. @returns their paths in the order of their positions; bad_input if the source is
/// not explicit little-endian DICOM with the fields to be changed.
[[nodiscard]] Result<std::vector<std::string>> write_long_series(const std::string& source_folder, const std::string& folder, int slices);

/// A second, simple reader for such files, as the baseline. @returns the values [HU] of all files: the pixels are the last bytes of a file,
/// HU = slope * pixel + intercept, and the two fields are found by a search.
[[nodiscard]] Result<std::vector<float>> read_plainly(const std::vector<std::string>& files);

}  // namespace burrhole
