/// app/report/file.h: reads and writes whole files.
///   Errors  bad_input with the path and the reason of the operating system.
#pragma once

#include <string>
#include <string_view>

#include "core/base/input_file.h"
#include "core/base/result.h"

namespace burrhole {

/// Writes a temporary file beside `path` and renames it, so that `path` always has either the old or the new content, also after a crash.
/// Creates missing folders. On an error the old file is unchanged.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);

/// @returns the bytes of a regular file, at most as many as its kind may have.
[[nodiscard]] Result<std::string> read_file(const std::string& path, const FileLimit& kind = kResultsInput);

}  // namespace burrhole
