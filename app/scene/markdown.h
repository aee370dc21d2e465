/// app/scene/markdown.h: text as GitHub's Markdown shows it and does not interpret it; both forms may stand in a cell of a table.
#pragma once

#include <string>
#include <string_view>

namespace burrhole {

/// Plain text: what Markdown would take as its own is escaped, a line break becomes a space.
[[nodiscard]] std::string markdown_text(std::string_view text);

/// Code, whatever backticks and bars it holds; never empty text.
[[nodiscard]] std::string markdown_code(std::string_view text);

}  // namespace burrhole
