/// app/report/csv.h: tables as CSV by RFC 4180: comma, CRLF, cells quoted only where they must be. Units belong in the column names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Numbers are written with the fewest digits that read back as the same bits; NaN is an empty cell (does not apply), true and false are
/// words.
using CsvCell = std::variant<std::string, double, std::int64_t, bool>;

/// @returns the fewest digits that read back as the same bits; "nan", "inf" and "-inf" for the rest.
[[nodiscard]] std::string shortest_number(double value);

/// A table with its columns fixed at the start.
class CsvTable {
 public:
  explicit CsvTable(const std::vector<std::string>& columns);
  /// Appends a row. Our bug if it has not one cell a column.
  void add_row(const std::vector<CsvCell>& cells);
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] Status write(const std::string& path) const;

 private:
  std::size_t columns_;
  std::string text_;
};

}  // namespace burrhole
