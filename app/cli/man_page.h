/// app/cli/man_page.h: the manual page burrhole(1) as troff, generated from the command tree.
#pragma once

#include <string>
#include <string_view>

#include "app/cli/command_tree.h"

namespace burrhole::cli {

/// @returns the page; it depends on the program and version only, and has no date.
[[nodiscard]] std::string man_page(const CommandNode& program, std::string_view version);

/// @returns running text with leading dots and quotes and all backslashes escaped for troff.
[[nodiscard]] std::string troff_text(std::string_view text);
/// @returns text to be typed literally: dashes, quotes and carets are escaped too.
[[nodiscard]] std::string troff_code(std::string_view text);

}  // namespace burrhole::cli
