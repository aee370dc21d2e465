#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "app/window/panel_text.h"

namespace burrhole {
namespace {

/// A font of which each letter is as wide.
float width_of(const std::string& row) { return static_cast<float>(row.size()); }

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

TEST_CASE("paragraph: rows are broken at blanks alone, hold at most the width, and have every word") {
  const std::string line = "the axis was clear after 40.12 s, the tip came out after 40.15 s, and it then plunged 16.67 mm.";
  for (const float width : {8.0f, 12.0f, 27.0f, 28.0f, 29.0f, 31.0f, 200.0f}) {
    CAPTURE(width);
    const std::string broken = broken_lines(line, width, width_of);
    CHECK(words_of(broken) == words_of(line));  // "40." and "12" would be two
    std::istringstream in(broken);
    for (std::string row; std::getline(in, row);) CHECK(width_of(row) <= width);
  }
  CHECK(broken_lines(line, 200.0f, width_of) == line);
}

TEST_CASE("paragraph: a word that is longer than the width has a row of its own") {
  CHECK(broken_lines("in out/parietal-20261127/report.html now", 10.0f, width_of) == "in\nout/parietal-20261127/report.html\nnow");
  CHECK(broken_lines("", 10.0f, width_of).empty());
}

}  // namespace
}  // namespace burrhole
