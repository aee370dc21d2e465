#include "app/report/csv.h"

#include <charconv>
#include <cmath>

#include "app/report/file.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

/// RFC 4180 section 2, rules 5 to 7: a cell with a comma, quote or line break is quoted; a quote inside is doubled.
std::string quoted_cell(std::string_view cell) {
  if (cell.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(cell);
  std::string out = "\"";
  for (const char c : cell) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

struct CellText {
  std::string operator()(const std::string& text) const { return quoted_cell(text); }
  std::string operator()(double value) const { return std::isnan(value) ? std::string() : shortest_number(value); }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
};

}  // namespace

std::string shortest_number(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end.ptr};
}

CsvTable::CsvTable(const std::vector<std::string>& columns) : columns_(columns.size()) {
  add_row(std::vector<CsvCell>(columns.begin(), columns.end()));
}

void CsvTable::add_row(const std::vector<CsvCell>& cells) {
  BH_ASSERT(cells.size() == columns_);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += ',';
    text_ += std::visit(CellText{}, cells[i]);
  }
  text_ += "\r\n";
}

Status CsvTable::write(const std::string& path) const { return write_file(path, text_); }

}  // namespace burrhole
