/// volumes/read/written_path.h: a path as it stands in a file, to where it leads.
#pragma once

#include <string>

#include "core/base/result.h"

namespace burrhole {

/// "$NAME/rest" with the environment's value of NAME; what is then relative lies beside `file`. @returns bad_input at `place` when the
/// variable is not set or empty. Does not ask whether anything is there.
[[nodiscard]] Result<std::string> written_path(const std::string& written, const std::string& file, const std::string& place);

}  // namespace burrhole
