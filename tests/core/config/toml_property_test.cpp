#include <doctest/doctest.h>

#include <string>

#include "core/base/random.h"
#include "core/config/toml.h"

using namespace burrhole;

namespace {

constexpr int kRounds = 20000;

std::uint64_t draw(std::uint64_t seed, std::uint64_t counter, std::uint64_t below) { return mix64(mix64(seed) ^ counter) % below; }

/// Asks everything of every key, whatever it holds: no answer may crash, and every issue is one line.
void read_all(TableReader table, int depth) {
  for (const std::string& key : table.keys()) {
    table.number(key, {.min = 0.0, .max = 1.0}, "a");
    table.integer(key, std::nullopt, 0, 5, "a");
    table.boolean(key, false, "a");
    table.text(key, std::nullopt, "a");
    table.choice(key, std::nullopt, {"a", "b"}, "a");
    table.vector(key, std::nullopt, {}, "a");
    if (depth > 3) continue;
    if (const auto sub = table.table(key, "a")) read_all(*sub, depth + 1);
    for (const TableReader& element : table.tables(key, "a")) read_all(element, depth + 1);
  }
  table.finish();
}

void check_text(const std::string& text) {
  const auto document = TomlDocument::parse(text, "f");
  if (!document) {
    CHECK(document.error().text().find('\n') == std::string::npos);
    return;
  }
  Issues issues;
  read_all(document.value().root(issues), 0);
  for (const Error& issue : issues) {
    CHECK(issue.text().find_first_of("\r\n") == std::string::npos);
    CHECK_FALSE(issue.place.empty());
  }
}

const std::string kSample =
    "title = \"Perforator 14/11\"\n[shell]\npitch_mm = 0.7\n[[region]]\nshape = 'cylinder'\nz_mm = 0x1F\nsize = [1, 2.5e3, -inf]\n"
    "when = 2020-01-02T03:04:05Z\nsub = { a = true, b.c = nan }\n[region.deep]\ntext = \"\"\"a\nb\\u00e9\"\"\"\n";

}  // namespace

TEST_CASE("parse: random bytes never crash it") {
  for (int round = 0; round < kRounds; ++round) {
    const auto seed = static_cast<std::uint64_t>(round);
    INFO("seed ", seed);
    std::string text(draw(seed, 0, 200), ' ');
    // every other round draws from the letters that TOML gives a meaning, so that more than the first byte is reached
    const std::string_view letters = "ab=[]{}.,\"'\n#_-+0129eEx:TZ\\u \t\r\xc3\xa9";
    for (std::size_t i = 0; i < text.size(); ++i)
      text[i] = round % 2 == 0 ? static_cast<char>(draw(seed, i + 1, 256)) : letters[draw(seed, i + 1, letters.size())];
    check_text(text);
  }
}

TEST_CASE("parse: a good file with a few bytes changed, lost or doubled never crashes it") {
  for (int round = 0; round < kRounds; ++round) {
    const auto seed = static_cast<std::uint64_t>(round) + 1000000;
    INFO("seed ", seed);
    std::string text = kSample;
    const std::uint64_t edits = 1 + draw(seed, 0, 4);
    for (std::uint64_t e = 0; e < edits; ++e) {
      const std::size_t at = draw(seed, 3 * e + 1, text.size());
      const auto byte = static_cast<char>(draw(seed, 3 * e + 2, 256));
      switch (draw(seed, 3 * e + 3, 3)) {
        case 0:
          text[at] = byte;
          break;
        case 1:
          text.erase(at, 1 + draw(seed, 99 + e, 20));
          break;
        default:
          text.insert(at, text.substr(at, draw(seed, 99 + e, 20)));
          break;
      }
      if (text.empty()) text = "x";
    }
    check_text(text);
  }
}

TEST_CASE("parse: brackets nested without end are refused, not followed into a stack overflow") {
  for (const char* open : {"[", "{a=", "[{a="}) {
    std::string text = "x = ";
    for (int i = 0; i < 100000; ++i) text += open;
    CHECK_FALSE(TomlDocument::parse(text, "f").ok());
  }
}

TEST_CASE("set: random assignments never crash it") {
  const auto document = TomlDocument::parse(kSample, "f");
  REQUIRE(document.ok());
  const std::string_view letters = "ab.=[]{}0123\"'-_ regionshell\n\xff";
  for (int round = 0; round < kRounds / 4; ++round) {
    const auto seed = static_cast<std::uint64_t>(round) + 2000000;
    INFO("seed ", seed);
    std::string text(draw(seed, 0, 30), ' ');
    for (std::size_t i = 0; i < text.size(); ++i) text[i] = letters[draw(seed, i + 1, letters.size())];
    TomlDocument copy = document.value();
    const Status status = copy.set(text);
    if (!status.ok()) CHECK(status.error().text().find_first_of("\r\n") == std::string::npos);
    CHECK_FALSE(copy.to_text().empty());
  }
}
