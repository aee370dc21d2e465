/// app/cli/man_page.h: the manual page burrhole(1) as troff, made from the walk of the command line.
#pragma once

#include <string>
#include <string_view>

#include "app/cli/command_tree.h"

namespace burrhole::cli {

/// The same text for the same program: no date in it.
[[nodiscard]] std::string man_page(const CommandNode& program, std::string_view version);

/// Running text for troff: no line of it is taken as a request, no backslash as an escape.
[[nodiscard]] std::string troff_text(std::string_view text);
/// Text to be typed as it stands: dashes, quotes and carets too.
[[nodiscard]] std::string troff_code(std::string_view text);

}  // namespace burrhole::cli
