#include "core/config/toml_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace burrhole {
namespace {

// Unit suffixes of keys in tool and scene files. A longer suffix precedes any suffix that it ends with, so the first match is the whole
// unit.
// clang-format off
constexpr std::array kUnitSuffixes = {
    "_nm_s_per_rad", "_nm_per_rad", "_kg_m2", "_ml_per_min", "_l_per_min", "_mm_per_min", "_j_per_mm3", "_n_per_mm", "_mm_per_s", "_ns_per_m",
    "_n_s_per_m", "_deg_per_s", "_n_per_m", "_n_per_s", "_m_per_s", "_um_per_rev", "_per_rev", "_per_mm", "_percent", "_n_mm", "_rad_s",
    "_mm_s", "_mm3", "_nmm", "_rpm", "_deg", "_rad", "_mm", "_um", "_cm", "_khz", "_hz", "_ms", "_us", "_min", "_kg", "_hu", "_px",
    "_mpa", "_db", "_nm", "_w", "_mj", "_j", "_n", "_s", "_c", "_m", "_g", "_voxels", "_ticks"};
// clang-format on

char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_unit(std::string_view suffix) {
  return std::any_of(kUnitSuffixes.begin(), kUnitSuffixes.end(), [&](std::string_view unit) {
    return std::equal(unit.begin(), unit.end(), suffix.begin(), suffix.end(), [](char a, char b) { return a == lower(b); });
  });
}

/// Edit distance (insert, delete, replace, swap of neighbours) between a and b, ignoring case; restricted Damerau-Levenshtein.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0u : 1u)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: not UTF-8
};

/// The UTF-8 character at text[i], in its shortest form and no surrogate (RFC 3629).
Character character_at(std::string_view text, std::size_t i) noexcept {
  const auto byte = static_cast<unsigned char>(text[i]);
  if (byte < 0x80) return {byte, 1};
  const std::size_t bytes = (byte >> 5) == 0x6 ? 2 : (byte >> 4) == 0xe ? 3 : (byte >> 3) == 0x1e ? 4 : 0;
  if (bytes == 0 || i + bytes > text.size()) return {};
  std::uint32_t code = byte & (0x7fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    const auto next = static_cast<unsigned char>(text[i + k]);
    if ((next >> 6) != 0x2) return {};
    code = code << 6 | (next & 0x3fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) return {};
  return {code, bytes};
}

/// Whether a terminal or a reader of lines acts on the character: controls (C0, DEL, C1), separators of lines, and those that change the
/// direction of writing, by which a message may show another order than it has.
bool acts(std::uint32_t code) noexcept {
  if (code < 0x20 || (code >= 0x7f && code < 0xa0)) return true;
  return code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069) ||
         code == 0xfeff;
}

std::string escaped(std::uint32_t code) {
  if (code == '\n') return "\\n";
  if (code == '\r') return "\\r";
  if (code == '\t') return "\\t";
  return code < 0x7f ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
}

}  // namespace

std::string one_line(std::string_view text, std::size_t max_bytes) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (out.size() >= max_bytes) return out + "...";
    const Character character = character_at(text, i);
    if (character.bytes == 0)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
    else if (acts(character.code))
      out += escaped(character.code);
    else
      out += text.substr(i, character.bytes);
    i += std::max<std::size_t>(character.bytes, 1);
  }
  return out;
}

std::string printable_text(std::string_view text) {
  constexpr std::string_view kKept = "\n\t";
  const auto plain = [](char c) { return (c >= 0x20 && c < 0x7f) || c == '\n' || c == '\t'; };
  if (std::ranges::all_of(text, plain)) return std::string(text);  // rows of numbers may have many megabytes
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(kKept), text.size());
    out += one_line(text.substr(0, end), std::numeric_limits<std::size_t>::max());
    if (end < text.size()) out += text[end];
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04x}", byte);
    else
      out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  }
  return out + '"';
}

std::string number_text(double value) { return fmt::format("{}", value); }

std::string range_text(const NumberRule& rule) {
  const bool low = std::isfinite(rule.min);
  const bool high = std::isfinite(rule.max);
  if (low && high) return fmt::format("must be in {}{}, {}{}", rule.min_open ? '(' : '[', rule.min, rule.max, rule.max_open ? ')' : ']');
  if (low) return fmt::format("must be {} {}", rule.min_open ? ">" : "at least", rule.min);
  if (high) return fmt::format("must be {} {}", rule.max_open ? "<" : "at most", rule.max);
  return "must be finite";
}

bool within(double written, const NumberRule& rule) noexcept {
  const bool above = rule.min_open ? written > rule.min : written >= rule.min;
  const bool below = rule.max_open ? written < rule.max : written <= rule.max;
  return std::isfinite(written) && above && below;
}

double value_inside(const NumberRule& rule) noexcept {
  if (rule.fallback && within(*rule.fallback, rule)) return *rule.fallback;
  const bool low = std::isfinite(rule.min);
  const bool high = std::isfinite(rule.max);
  if (low && high) return rule.min + 0.5 * (rule.max - rule.min);
  if (low) return rule.min_open ? rule.min + 1.0 : rule.min;
  if (high) return rule.max_open ? rule.max - 1.0 : rule.max;
  return 0.0;
}

std::optional<std::string> with_unit(std::string_view word, const std::vector<std::string>& known) {
  for (const std::string& name : known)
    if (name.size() > word.size() && std::string_view(name).substr(0, word.size()) == word &&
        is_unit(std::string_view(name).substr(word.size())))
      return name;
  return std::nullopt;
}

std::string_view unit_suffix(std::string_view key) {
  for (std::size_t cut = key.find('_', 1); cut != std::string_view::npos; cut = key.find('_', cut + 1))
    if (is_unit(key.substr(cut))) return key.substr(cut);
  return {};
}

std::optional<std::string> number_without_unit(std::string_view key, std::string_view value) {
  double number = 0.0;
  const char* const end = value.data() + value.size();
  const auto [rest, error] = std::from_chars(value.data(), end, number);
  if (error != std::errc() || rest == end || !std::isfinite(number)) return std::nullopt;
  const std::string written(value.data(), rest);
  // As in the name of a key: "mm/s" is "_mm_per_s".
  std::string unit = "_";
  for (const char c : std::string_view(rest, end)) {
    if (c == '/')
      unit += "_per_";
    else if (c != ' ' && c != '"')
      unit += c;
  }
  const std::string_view last = key.substr(key.rfind('.') + 1), own = unit_suffix(last.substr(0, last.find('[')));
  if (unit == "_%") {
    if (own == "_percent") return fmt::format("write {}; the unit is in the key's name", written);
    return fmt::format("write {:.6g}: a share is a number, and 1 is all", number / 100.0);
  }
  if (!is_unit(unit)) return std::nullopt;
  const bool same = std::equal(own.begin(), own.end(), unit.begin(), unit.end(), [](char a, char b) { return lower(a) == lower(b); });
  if (same) return fmt::format("write {}; the unit is in the key's name", written);
  if (own.empty()) return fmt::format("the unit is in the key's name: write {}{}={}", key, unit, written);
  return fmt::format("write a number alone: the unit is that of the key's name, {}", own.substr(1));
}

std::optional<std::string_view> without_unit(std::string_view key) {
  const std::string_view suffix = unit_suffix(key);
  return suffix.empty() ? std::nullopt : std::optional(key.substr(0, key.size() - suffix.size()));
}

std::optional<std::string> nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongestName = 200;  // [bytes] the distance takes time by the product of both lengths
  if (word.size() > kLongestName) return std::nullopt;
  // A typing error changes at most a third of the letters, and three at most.
  const std::size_t limit = std::min<std::size_t>(3, (word.size() + 1) / 3);
  std::size_t best = limit + 1;
  const std::string* found = nullptr;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(candidate.size(), word.size());
    if (longer - std::min(candidate.size(), word.size()) > limit) continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best) {
      best = distance;
      found = &candidate;
    }
  }
  if (found != nullptr) return *found;
  // A name that is typed in part.
  constexpr std::size_t kPart = 4;
  const auto begins = [&](const std::string& name) {
    return name.size() > word.size() &&
           std::equal(word.begin(), word.end(), name.begin(), [](char a, char b) { return lower(a) == lower(b); });
  };
  if (word.size() < kPart || std::ranges::count_if(candidates, begins) != 1) return std::nullopt;
  return *std::ranges::find_if(candidates, begins);
}

}  // namespace burrhole
