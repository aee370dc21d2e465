/// volumes/read/raw_template.h: a description to fill in, for files that may hold raw voxels.   Thread  any.   Errors  none; opens no file.
#pragma once

#include <span>
#include <string>

namespace burrhole {

/// @returns in one line what to write into a description of raw voxels: the files by their names, and capitals for what only their author
/// knows. Files whose names differ in one number are taken as slices. Empty if there are no files.
[[nodiscard]] std::string raw_template(std::span<const std::string> files);

/// @returns whether a name ends as files of raw voxels usually do.
[[nodiscard]] bool named_as_raw(const std::string& path);

}  // namespace burrhole
