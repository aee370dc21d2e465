/// app/report/csv.h: writes tables as CSV (RFC 4180): comma, CRLF, cells quoted only if necessary.
///   Units  belong in the column names.   Errors  bad_input if the file cannot be written.   Thread  one owner.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// A cell. Numbers are written with the fewest digits that read back as the same bits. NaN is an empty cell (does not apply); booleans are
/// "true" and "false".
using CsvCell = std::variant<std::string, double, std::int64_t, bool>;

/// @returns the fewest digits that read back as the same bits; "nan", "inf" and "-inf" for other values.
[[nodiscard]] std::string shortest_number(double value);

/// A table with a fixed list of columns.
class CsvTable {
 public:
  explicit CsvTable(const std::vector<std::string>& columns);
  /// Appends a row. @pre it has one cell per column.
  void add_row(const std::vector<CsvCell>& cells);
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] Status write(const std::string& path) const;

 private:
  std::size_t columns_;
  std::string text_;
};

}  // namespace burrhole
