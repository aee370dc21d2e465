#include "app/scene/markdown.h"

#include <doctest/doctest.h>

using burrhole::markdown_code;
using burrhole::markdown_text;

TEST_CASE("markdown: plain text stays as it is read") {
  CHECK(markdown_text("radius, in (0, 20] mm; 1/voxel") == "radius, in (0, 20] mm; 1/voxel");
  CHECK(markdown_text("divides servo_hz") == "divides servo_hz");  // within a word it marks nothing
  CHECK(markdown_text("") == "");
}

TEST_CASE("markdown: text cannot end its cell, open markup or make a link") {
  CHECK(markdown_text("a | b") == "a \\| b");
  CHECK(markdown_text("*a* `b` <c> &amp; \\d ~~e~~") == "\\*a\\* \\`b\\` \\<c> \\&amp; \\\\d \\~\\~e\\~\\~");
  CHECK(markdown_text("_a_") == "\\_a\\_");
  CHECK(markdown_text("[a](b) [a][b] [a]: b") == "[a]\\(b) [a]\\[b] [a]\\: b");
  CHECK(markdown_text("two\nlines") == "two lines");
}

TEST_CASE("markdown: code is fenced by more backticks than it holds") {
  CHECK(markdown_code("spacing_mm") == "`spacing_mm`");
  CHECK(markdown_code("a`b") == "``a`b``");
  CHECK(markdown_code("``") == "``` `` ```");
  CHECK(markdown_code("`a") == "`` `a ``");
  CHECK(markdown_code("a|b") == "`a\\|b`");  // GitHub's tables split at bars in code too
  CHECK(markdown_code("a\nb") == "`a b`");
}
