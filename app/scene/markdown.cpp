#include "app/scene/markdown.h"

#include <algorithm>
#include <cctype>

namespace burrhole {
namespace {

/// @returns the length of the longest run of backticks.
std::size_t longest_fence(std::string_view text) {
  std::size_t longest = 0, run = 0;
  for (const char c : text) {
    run = c == '`' ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

}  // namespace

std::string markdown_text(std::string_view text) {
  // Special characters inside a line; '&' starts an entity, '|' ends a cell. '[' alone is not special: a link needs "](".
  constexpr std::string_view kSpecial = "\\`*<|&~";
  const auto is_word = [&](std::size_t at) { return at < text.size() && std::isalnum(static_cast<unsigned char>(text[at])) != 0; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool breaks = c == '\n' || c == '\r';
    const bool emphasis = c == '_' && !(i > 0 && is_word(i - 1) && is_word(i + 1));  // inside a word it is a letter
    const bool link = (c == '(' || c == '[' || c == ':') && i > 0 && text[i - 1] == ']';
    if (kSpecial.find(c) != std::string_view::npos || emphasis || link) out += '\\';
    out += breaks ? ' ' : c;
  }
  return out;
}

std::string markdown_code(std::string_view text) {
  const std::string fence(longest_fence(text) + 1, '`');
  // A backtick at an end would join the fence, so a space separates them; Markdown removes one space on each side.
  const bool padded = text.starts_with('`') || text.ends_with('`');
  std::string out = fence + (padded ? " " : "");
  for (const char c : text) {
    if (c == '|') out += '\\';  // a table splits its cells before it parses code
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + (padded ? " " : "") + fence;
}

}  // namespace burrhole
