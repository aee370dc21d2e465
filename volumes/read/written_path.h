/// volumes/read/written_path.h: resolves a path written in a file.
///   Errors  bad_input.
#pragma once

#include <string>

#include "core/base/result.h"

namespace burrhole {

/// @returns the path with "$NAME/rest" replaced by the environment's value of NAME; a relative path is relative to the folder of `file`.
/// bad_input at `place` if the variable is not set or empty. It does not check that the path exists.
[[nodiscard]] Result<std::string> written_path(const std::string& written, const std::string& file, const std::string& place);

/// @returns for a path below $BURRHOLE_DATA how to get the scans of the shipped scenes, to be appended to an error; empty for another path.
[[nodiscard]] std::string missing_data_note(const std::string& written);

}  // namespace burrhole
