#include "app/report/csv.h"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace burrhole {
namespace {

/// A reader that shares no code with the writer: RFC 4180 by its own rules, character by character.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inside && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += '"';
      ++i;
    } else if (c == '"') {
      inside = !inside;
    } else if (!inside && c == ',') {
      rows.back().emplace_back();
    } else if (!inside && c == '\r') {
      ++i;
      if (i + 1 < text.size()) rows.emplace_back(1);
    } else {
      rows.back().back() += c;
    }
  }
  return rows;
}

TEST_CASE("csv: cells with commas, quotes and line breaks read back as written") {
  CsvTable table({"name", "note"});
  table.add_row({std::string("plain"), std::string("a,b")});
  table.add_row({std::string("say \"no\""), std::string("two\r\nlines")});
  table.add_row({std::string(""), std::string("\"")});
  const auto rows = parse_csv(table.text());
  REQUIRE(rows.size() == 4);
  CHECK(rows[0] == std::vector<std::string>{"name", "note"});
  CHECK(rows[1] == std::vector<std::string>{"plain", "a,b"});
  CHECK(rows[2] == std::vector<std::string>{"say \"no\"", "two\r\nlines"});
  CHECK(rows[3] == std::vector<std::string>{"", "\""});
}

TEST_CASE("csv: plain cells are not quoted and rows end in CRLF") {
  CsvTable table({"a", "b", "c"});
  table.add_row({std::string("x"), std::int64_t{-3}, true});
  CHECK(table.text() == "a,b,c\r\nx,-3,true\r\n");
}

TEST_CASE("csv: numbers read back as the same bits and with the fewest digits") {
  CHECK(shortest_number(0.1) == "0.1");
  CHECK(shortest_number(1e300) == "1e+300");
  CHECK(shortest_number(-0.0) == "-0");
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(mix64(i));
    if (!std::isfinite(value)) continue;
    const std::string text = shortest_number(value);
    double back = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    REQUIRE(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(value));
  }
}

TEST_CASE("csv: NaN is an empty cell and infinity a word") {
  CsvTable table({"a", "b"});
  table.add_row({std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()});
  CHECK(table.text() == "a,b\r\n,-inf\r\n");
}

}  // namespace
}  // namespace burrhole
