#include <doctest/doctest.h>

#include "core/config/toml.h"
#include "core/config/toml_messages.h"

using namespace burrhole;

TEST_CASE("one_line: what a terminal acts on is escaped, other text of any language stays") {
  CHECK(one_line("Schädel 頭蓋骨 🦴") == "Schädel 頭蓋骨 🦴");
  CHECK(one_line("a\nb\tc\rd") == "a\\nb\\tc\\rd");
  CHECK(one_line("\x1b[2J") == "\\x1b[2J");
  CHECK(one_line("\x7f") == "\\u007f");
  CHECK(one_line("\u009b31m") == "\\u009b31m");                                      // ESC [ in one character
  CHECK(one_line("\u202egpj.exe\u2028x\ufeff") == "\\u202egpj.exe\\u2028x\\ufeff");  // turns the direction of writing
  CHECK(one_line(std::string("a\0b", 3)) == "a\\x00b");
}

TEST_CASE("one_line: bytes that are not UTF-8 are escaped one by one") {
  CHECK(one_line("a\xff\x80z") == "a\\xff\\x80z");
  CHECK(one_line("\xc0\xaf") == "\\xc0\\xaf");           // a slash in more bytes than it needs
  CHECK(one_line("\xed\xa0\x80") == "\\xed\\xa0\\x80");  // a surrogate
  CHECK(one_line("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
  CHECK(one_line("\xe9\xa0") == "\\xe9\\xa0");  // cut off
}

TEST_CASE("one_line: a cut lies between two characters") {
  std::string long_text;
  for (int n = 0; n < 100; ++n) long_text += "頭";
  for (std::size_t most = 1; most < 20; ++most) CHECK(one_line(long_text, most) == long_text.substr(0, (most + 2) / 3 * 3) + "...");
  CHECK(one_line("abc", 3) == "abc");
  CHECK(one_line("abcd", 3) == "abc...");
}

TEST_CASE("printable_text: lines and tabulators stay, other controls are escaped") {
  CHECK(printable_text("a\tb\n\nc") == "a\tb\n\nc");
  CHECK(printable_text("ä\x1b[0m\n\u0085\n") == "ä\\x1b[0m\n\\u0085\n");
  CHECK(printable_text("") == "");
}

TEST_CASE("toml_string: TOML reads back any text of a path") {
  for (const std::string text : {"a\nb", "q\"uote\\", "tab\there", "\x1b", "\x7f", "頭/x'y"}) {
    const auto document = TomlDocument::parse("a = " + toml_string(text) + "\n", "f.toml");
    REQUIRE_MESSAGE(document.ok(), text);
    Issues issues;
    CHECK(document->root(issues).text("a", "", "") == text);
  }
}

TEST_CASE("nearest_name: a very long word has none") {
  CHECK_FALSE(nearest_name(std::string(1'000'000, 'a'), {std::string(1'000'000, 'b')}).has_value());
}
