#include "volumes/read/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace burrhole {
namespace {

constexpr int kWidest = 18;                       ///< digits of a number in a file name
constexpr std::int64_t kLargest = 1'000'000'000;  ///< magnitude of such a number

template <class T>
std::optional<T> whole_text(std::string_view text) noexcept {
  if (text.size() > kLongestNumber) return std::nullopt;
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

}  // namespace

std::string_view trimmed(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto end = std::find_if(text.begin(), text.end(), is_blank);
    words.push_back(text.substr(0, static_cast<std::size_t>(end - text.begin())));
    text.remove_prefix(words.back().size());
  }
  return words;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::optional<double> number_of(std::string_view text) noexcept { return whole_text<double>(text); }
std::optional<std::int64_t> whole_of(std::string_view text) noexcept { return whole_text<std::int64_t>(text); }

std::optional<std::vector<double>> numbers_of(std::string_view text, std::size_t count) {
  const auto words = words_of(text);
  if (words.size() != count) return std::nullopt;
  std::vector<double> values;
  for (const std::string_view word : words) {
    const auto value = number_of(word);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<std::vector<std::int64_t>> wholes_of(std::string_view text, std::size_t count) {
  const auto words = words_of(text);
  if (words.size() != count) return std::nullopt;
  std::vector<std::int64_t> values;
  for (const std::string_view word : words) {
    const auto value = whole_of(word);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<std::string_view> take_line(std::string_view& rest) noexcept {
  if (rest.empty()) return std::nullopt;
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::uint64_t NumberedNames::count() const noexcept { return static_cast<std::uint64_t>((last - first) / step) + 1; }

std::string NumberedNames::name(std::uint64_t n) const {
  const std::int64_t number = first + static_cast<std::int64_t>(n) * step;
  return before + (zeros ? fmt::format("{:0{}d}", number, width) : fmt::format("{:{}d}", number, width)) + after;
}

std::optional<NumberedNames> numbered_names(std::string_view format, std::int64_t first, std::int64_t last, std::int64_t step) {
  for (const std::int64_t number : {first, last, step})
    if (number > kLargest || number < -kLargest) return std::nullopt;
  if (step == 0 || (last - first) / step < 0) return std::nullopt;
  const std::size_t percent = format.find('%');
  if (percent == std::string_view::npos) return std::nullopt;
  NumberedNames out{.before = std::string(format.substr(0, percent)), .first = first, .last = last, .step = step};
  std::size_t at = percent + 1;
  out.zeros = at < format.size() && format[at] == '0';
  for (; at < format.size() && is_digit(format[at]); ++at) {
    out.width = out.width * 10 + (format[at] - '0');
    if (out.width > kWidest) return std::nullopt;
  }
  if (at >= format.size() || (format[at] != 'd' && format[at] != 'i' && format[at] != 'u')) return std::nullopt;
  out.after = format.substr(at + 1);
  if (out.after.find('%') != std::string::npos) return std::nullopt;
  return out;
}

}  // namespace burrhole
