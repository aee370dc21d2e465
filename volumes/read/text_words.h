/// volumes/read/text_words.h: splits a text into words and lines without copies, and parses numbers independent of the locale.
///   Errors  an empty result.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>

namespace burrhole {

/// Words separated by blanks; a line end is a blank.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  /// @returns the next word, empty at the end.
  std::string_view next() noexcept {
    std::size_t at = 0;
    while (at < rest_.size() && is_blank(rest_[at])) ++at;
    std::size_t end = at;
    while (end < rest_.size() && !is_blank(rest_[end])) ++end;
    const std::string_view word = rest_.substr(at, end - at);
    rest_.remove_prefix(end);
    return word;
  }
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

 private:
  [[nodiscard]] static bool is_blank(char c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }
  std::string_view rest_;
};

/// Lines ended by "\n" or "\r\n", numbered from 1.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) noexcept {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const noexcept { return number_; }  ///< of the last line returned
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// @returns the whole word as a number, or nothing. "nan" and "inf" are numbers; T may be an integer.
template <class T>
[[nodiscard]] std::optional<T> number_of(std::string_view word) noexcept {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  T value{};
  const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace burrhole
