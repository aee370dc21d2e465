/// app/bench/dicom_series.h: a long DICOM series made from a short real one: the same slices over and over, 1 mm apart, each with its own
/// position and UID, all else byte for byte. For measuring imports at the size of a whole head.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Writes `slices` files into `folder`, which must exist. @returns their paths in the order of their positions; bad_input when the source
/// holds no explicit little-endian DICOM with the fields to be changed.
[[nodiscard]] Result<std::vector<std::string>> write_long_series(const std::string& source_folder, const std::string& folder, int slices);

/// The twin of the reader for such files: pixels are the last bytes, HU = slope * pixel + intercept by a search for the two fields.
[[nodiscard]] Result<std::vector<float>> read_plainly(const std::vector<std::string>& files);

}  // namespace burrhole
