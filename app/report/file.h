/// app/report/file.h: reads and writes whole files.
///   Errors  bad_input with the path and the reason of the operating system.
#pragma once

#include <string>
#include <string_view>

#include "core/base/input_file.h"
#include "core/base/result.h"

namespace burrhole {

/// Writes a file as OutputFile does (core/base/output_file.h): the old content or the new, also after a crash or on a full disk.
/// Creates missing folders.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);

/// @returns the bytes of a regular file, at most as many as its kind may have.
[[nodiscard]] Result<std::string> read_file(const std::string& path, const FileLimit& kind = kResultsInput);

}  // namespace burrhole
