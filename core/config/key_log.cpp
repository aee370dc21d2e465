#include "core/config/key_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "core/config/toml.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

/// Shortest text to 12 digits, since a value that was converted from SI is off in the last of 16. Large bounds are written as powers of
/// ten, which are easier to read.
std::string bound_text(double value) {
  if (std::abs(value) < 1e5) return fmt::format("{:.12g}", value);
  std::string text = fmt::format("{:e}", value);  // 1.000000e+09
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  return digits + "e" + std::to_string(std::atoi(text.c_str() + e + 1));
}

std::string range_of(const NumberRule& rule) {
  const bool low = std::isfinite(rule.min);
  const bool high = std::isfinite(rule.max);
  if (!low && !high) return {};
  return fmt::format("{}{}, {}{}", low && !rule.min_open ? '[' : '(', low ? bound_text(rule.min) : "-inf",
                     high ? bound_text(rule.max) : "inf", high && !rule.max_open ? ']' : ')');
}

std::string quoted(const std::string& word) { return '"' + word + '"'; }

/// Words of a unit that keys write in lower case only.
std::string unit_word(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kAsWritten{{{"hz", "Hz"},
                                                                                      {"khz", "kHz"},
                                                                                      {"hu", "HU"},
                                                                                      {"mpa", "MPa"},
                                                                                      {"db", "dB"},
                                                                                      {"w", "W"},
                                                                                      {"j", "J"},
                                                                                      {"c", "degrees C"},
                                                                                      {"percent", "%"},
                                                                                      {"mm3", "mm^3"},
                                                                                      {"nmm", "N mm"},
                                                                                      {"Nm", "N m"},
                                                                                      {"m2", "m^2"},
                                                                                      {"n", "N"},
                                                                                      {"ns", "N s"}}};
  for (const auto& [in_key, as_written] : kAsWritten)
    if (word == in_key) return std::string(as_written);
  return std::string(word);
}

}  // namespace

std::string_view name_of(KeyKind kind) noexcept {
  constexpr std::array<std::string_view, 8> kNames{"number", "whole number", "true or false", "text", "word", "numbers", "table", "tables"};
  return kNames[static_cast<std::size_t>(kind)];
}

void KeyLog::note(KeyInfo info) {
  const auto same =
      std::find_if(keys.begin(), keys.end(), [&](const KeyInfo& old) { return old.table == info.table && old.key == info.key; });
  if (same == keys.end()) {
    keys.push_back(std::move(info));
    return;
  }
  const bool says_more = (same->about.empty() && !info.about.empty()) || (same->kind == KeyKind::text && info.kind == KeyKind::choice);
  info.present = same->present = info.present || same->present;
  if (says_more) *same = std::move(info);
}

KeyInfo number_key(const NumberRule& rule, std::string_view about) {
  KeyInfo info;
  info.kind = KeyKind::number;
  // A fallback outside the rule's own range is not a value of the key: it means "none".
  info.fallback = !rule.fallback                  ? std::string(kRequiredKey)
                  : !within(*rule.fallback, rule) ? std::string(kNoDefault)
                                                  : bound_text(*rule.fallback);
  info.range = range_of(rule);
  info.about = about;
  return info;
}

KeyInfo integer_key(std::optional<std::int64_t> fallback, std::int64_t min, std::int64_t max, std::string_view about) {
  KeyInfo info;
  info.kind = KeyKind::integer;
  info.fallback = !fallback                            ? std::string(kRequiredKey)
                  : *fallback < min || *fallback > max ? std::string(kNoDefault)
                                                       : std::to_string(*fallback);
  const bool low = min != std::numeric_limits<std::int64_t>::min();
  const bool high = max != std::numeric_limits<std::int64_t>::max();
  if (low || high)
    info.range = fmt::format("{}{}, {}{}", low ? '[' : '(', low ? std::to_string(min) : "-inf", high ? std::to_string(max) : "inf",
                             high ? ']' : ')');
  info.about = about;
  return info;
}

KeyInfo boolean_key(bool fallback, std::string_view about) {
  KeyInfo info;
  info.kind = KeyKind::boolean;
  info.fallback = fallback ? "true" : "false";
  info.about = about;
  return info;
}

KeyInfo text_key(const std::optional<std::string>& fallback, std::string_view about) {
  KeyInfo info;
  info.kind = KeyKind::text;
  info.fallback = !fallback ? std::string(kRequiredKey) : fallback->empty() ? std::string(kNoDefault) : quoted(*fallback);
  info.word = fallback.value_or("");
  info.about = about;
  return info;
}

KeyInfo choice_key(const std::optional<std::string>& fallback, const std::vector<std::string>& allowed,
                   const std::vector<std::string>& later, std::string_view about) {
  KeyInfo info = text_key(fallback, about);
  info.kind = KeyKind::choice;
  info.allowed = allowed;
  info.later = later;
  return info;
}

KeyInfo numbers_key(const std::optional<std::vector<double>>& fallback, std::size_t count, const NumberRule& rule, std::string_view about) {
  KeyInfo info = number_key(rule, about);
  info.kind = KeyKind::numbers;
  info.count = count;
  info.fallback = kRequiredKey;
  if (fallback) {
    std::vector<std::string> words;
    for (const double value : *fallback) words.push_back(bound_text(value));
    info.fallback = fmt::format("[{}]", fmt::join(words, ", "));
  }
  return info;
}

KeyInfo table_key(KeyKind kind, std::string_view about) {
  KeyInfo info;
  info.kind = kind;
  info.about = about;
  return info;
}

std::string without_indices(std::string_view path) {
  std::string out;
  bool inside = false;
  for (const char c : path) {
    inside = inside && c != ']';
    if (!inside) out += c;
    inside = inside || c == '[';
  }
  return out;
}

std::string unit_of(std::string_view key) {
  std::string_view rest = unit_suffix(key);
  if (rest.empty()) return {};
  rest.remove_prefix(1);
  std::string out;
  for (std::string_view joint = ""; !rest.empty();) {
    const std::size_t end = std::min(rest.find('_'), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (word == "per") {
      joint = out.empty() ? "1/" : "/";
      continue;
    }
    out.append(joint).append(unit_word(word));
    joint = " ";
  }
  return out;
}

}  // namespace burrhole
