/// core/base/key_log.h: what a document's readers asked for, as data: references of file formats are printed from it, so they cannot
/// say anything else than the code that parses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace burrhole {

struct NumberRule;

enum class KeyKind : std::uint8_t { number, integer, boolean, text, choice, numbers, table, tables };
/// "number", "whole number", ...: the words of a reference.
[[nodiscard]] std::string_view name_of(KeyKind kind) noexcept;

/// Default of a key that must be there, and of one whose absence means that there is no such thing.
inline constexpr std::string_view kRequiredKey = "required";
inline constexpr std::string_view kNoDefault = "none";

/// One key as a reader knows it, whether the file has it or not.
struct KeyInfo {
  std::string table;  ///< dotted path, an array of tables as "region[]"; empty for the root
  std::string key;
  KeyKind kind = KeyKind::text;
  std::size_t count = 1;  ///< numbers in the array, for kind numbers; a vector has 3
  std::string unit;       ///< "mm", "N s/m": what the key's suffix says; empty when it wears none
  std::string fallback;   ///< as TOML writes it, kRequiredKey or kNoDefault; empty for tables
  std::string range;      ///< of each number as written, "(0, 20]", "[0, inf)"; empty: any finite number
  std::vector<std::string> allowed;
  std::vector<std::string> later;  ///< words known but not in this version
  std::string about;

  // What this one document had.
  bool present = false;
  std::string word;  ///< as read, for kinds text and choice
};

/// Every key that the readers of a document were asked for, in the order of asking. Questions by has() alone are no records.
struct KeyLog {
  std::vector<KeyInfo> keys;

  /// Adds a record. Of two about one key (read twice, or in each element of an array of tables) the first stands, unless the second says
  /// more: it has the `about`, or is the choice of words where the first only looked at the text.
  void note(KeyInfo info);
};

// Records of one read, without table, key, unit and presence, which the reader adds.
[[nodiscard]] KeyInfo number_key(const NumberRule& rule, std::string_view about);
[[nodiscard]] KeyInfo integer_key(std::optional<std::int64_t> fallback, std::int64_t min, std::int64_t max, std::string_view about);
[[nodiscard]] KeyInfo boolean_key(bool fallback, std::string_view about);
[[nodiscard]] KeyInfo text_key(const std::optional<std::string>& fallback, std::string_view about);
[[nodiscard]] KeyInfo choice_key(const std::optional<std::string>& fallback, const std::vector<std::string>& allowed,
                                 const std::vector<std::string>& later, std::string_view about);
[[nodiscard]] KeyInfo numbers_key(const std::optional<std::vector<double>>& fallback, std::size_t count, const NumberRule& rule,
                                  std::string_view about);
[[nodiscard]] KeyInfo table_key(KeyKind kind, std::string_view about);

/// "region[3].part[0]" -> "region[].part[]".
[[nodiscard]] std::string without_indices(std::string_view path);

/// The unit that a key wears, as people write it: "coupling_N_s_per_m" -> "N s/m", "rate_hz" -> "Hz"; empty when it wears none.
[[nodiscard]] std::string unit_of(std::string_view key);

}  // namespace burrhole
