/// app/cli/picture_difference.h: where two pictures of the same view differ.   Errors  bad_input of read_png() and write_png().
#pragma once

#include <string>

#include "core/base/result.h"

namespace burrhole::cli {

inline constexpr const char* kNoDifference = "no difference";

/// Writes the first picture in pale grey, with orange where the second differs; full orange is a difference of 64 of 255 in any channel.
/// @returns a sentence with the share of pixels that differ. No file, and kNoDifference, if none does; no file, and empty, if the sizes
/// differ.
[[nodiscard]] Result<std::string> write_picture_difference(const std::string& first, const std::string& second, const std::string& file);

}  // namespace burrhole::cli
