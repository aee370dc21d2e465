/// tests/support/xml_check.h: is a text well-formed XML, as far as a plot or a page needs: every tag closed in order, one root.
#pragma once

#include <string>
#include <vector>

namespace burrhole {

/// @returns what is wrong, empty if nothing. Attributes and entities are not looked into; `<` must be escaped in text.
[[nodiscard]] inline std::string xml_fault(const std::string& text) {
  std::vector<std::string> open;
  bool root_seen = false;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = text.find("-->", at);
      if (at == std::string::npos) return "a comment does not end";
      continue;
    }
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) return "a tag does not end";
    if (text[at + 1] == '?' || text[at + 1] == '!') continue;
    const bool closing = text[at + 1] == '/';
    const std::size_t begin = at + (closing ? 2 : 1);
    const std::string name = text.substr(begin, text.find_first_of(" \t\r\n/>", begin) - begin);
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
      open.pop_back();
    } else {
      if (open.empty() && root_seen) return "a second root <" + name + ">";
      root_seen = true;
      if (text[end - 1] != '/') open.push_back(name);
    }
  }
  if (!open.empty()) return "<" + open.back() + "> is left open";
  return root_seen ? "" : "there is no element";
}

}  // namespace burrhole
