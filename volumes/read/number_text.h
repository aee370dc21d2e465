/// volumes/read/number_text.h: words, numbers and file names in text headers (NRRD, MetaImage). Independent of the locale; no file access.
///   Errors  an empty optional.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace burrhole {

inline constexpr std::size_t kLongestNumber = 64;  ///< [bytes] longest text of a number

[[nodiscard]] constexpr bool is_blank(char c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }
/// @returns the text without blanks at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view text);
/// @returns the text with ASCII letters in lower case.
[[nodiscard]] std::string lower(std::string_view text);

/// @returns the whole text as a number, else nothing; "nan" and "inf" are numbers.
[[nodiscard]] std::optional<double> number_of(std::string_view text) noexcept;
[[nodiscard]] std::optional<std::int64_t> whole_of(std::string_view text) noexcept;
/// @returns exactly `count` finite numbers separated by blanks; nothing if there is any other word.
[[nodiscard]] std::optional<std::vector<double>> numbers_of(std::string_view text, std::size_t count);
[[nodiscard]] std::optional<std::vector<std::int64_t>> wholes_of(std::string_view text, std::size_t count);

/// Removes the first line from `rest` and returns it without its end (LF or CR LF); nothing if `rest` is empty.
[[nodiscard]] std::optional<std::string_view> take_line(std::string_view& rest) noexcept;

/// "slice%03d.raw 1 93 1": numbered file names, as NRRD and MetaImage write them.
struct NumberedNames {
  std::string before, after{};
  int width = 0;  ///< [digits] smallest number of digits
  bool zeros = false;
  std::int64_t first = 0, last = 0, step = 1;

  /// @returns the number of names.
  [[nodiscard]] std::uint64_t count() const noexcept;
  [[nodiscard]] std::string name(std::uint64_t n) const;
};

/// From the printf-like format and "first last step"; nothing unless the format has exactly one %d (%3d, %03d) and `step` leads to `last`.
[[nodiscard]] std::optional<NumberedNames> numbered_names(std::string_view format, std::int64_t first, std::int64_t last,
                                                          std::int64_t step);

}  // namespace burrhole
