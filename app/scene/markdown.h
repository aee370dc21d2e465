/// app/scene/markdown.h: escapes text for GitHub's Markdown, also inside the cells of a table.   Thread  any.
#pragma once

#include <string>
#include <string_view>

namespace burrhole {

/// @returns `text` with Markdown's special characters escaped and line breaks replaced by spaces, for a paragraph or a cell.
[[nodiscard]] std::string markdown_text(std::string_view text);

/// @returns `text` as a code span for a cell, with line breaks replaced by spaces; it may contain backticks. Each | is escaped, as a cell
/// requires: outside a table the backslash before | is visible. @param text not empty.
[[nodiscard]] std::string markdown_code(std::string_view text);

}  // namespace burrhole
