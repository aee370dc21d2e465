/// app/scene/markdown.h: escapes text for GitHub's Markdown. The results are valid inside a cell of a table.   Thread  any.
#pragma once

#include <string>
#include <string_view>

namespace burrhole {

/// @returns plain text with Markdown's special characters escaped; a line break becomes a space.
[[nodiscard]] std::string markdown_text(std::string_view text);

/// @returns a code span; the text may contain backticks and bars. @param text not empty.
[[nodiscard]] std::string markdown_code(std::string_view text);

}  // namespace burrhole
