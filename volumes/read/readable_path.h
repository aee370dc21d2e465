/// volumes/read/readable_path.h: the one volume that a folder holds.   Errors  bad_input.   Thread  any; reads the first bytes of files.
#pragma once

#include <string>

#include "core/base/result.h"

namespace burrhole {

/// @returns of a folder without DICOM that holds one volume of another format, or the .toml of a raw one, the path of that file; any other
/// path unchanged. bad_input if such a folder holds several.
[[nodiscard]] Result<std::string> readable_path(const std::string& path);

}  // namespace burrhole
