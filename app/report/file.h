/// app/report/file.h: whole files, read and written at once.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

/// Writes a temporary file beside `path` and renames it: a reader, or a run that was cut short, sees the old file or the new one, never
/// half. Folders that lack are made. Errors: bad_input with the path and the system's reason; the old file is then untouched.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);

/// @returns the bytes of a file; bad_input with the path and the reason if it cannot be read.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

}  // namespace burrhole
