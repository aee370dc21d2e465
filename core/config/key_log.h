/// core/config/key_log.h: record of the keys that the readers of a document request, as data. The reference of a file format is printed
///   from this record, so it cannot differ from the code that parses.   Thread  one owner.
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
/// @returns the name of a kind as the reference prints it: "number", "whole number", ...
[[nodiscard]] std::string_view name_of(KeyKind kind) noexcept;

/// Values of KeyInfo::fallback: the key is required; the key has no default because its absence disables the feature.
inline constexpr std::string_view kRequiredKey = "required";
inline constexpr std::string_view kNoDefault = "none";

/// One key as a reader requests it, whether or not the file contains it.
struct KeyInfo {
  std::string table;  ///< dotted path; an array of tables as "region[]"; empty for the root
  std::string key;
  KeyKind kind = KeyKind::text;
  std::size_t count = 1;  ///< numbers in the array, for kind `numbers`; a vector has 3
  std::string unit;       ///< "mm", "N s/m": from the suffix of the key; empty if it has none
  std::string fallback;   ///< as TOML writes it, or kRequiredKey or kNoDefault; empty for tables
  std::string range;      ///< range of each number as written, "(0, 20]", "[0, inf)"; empty: any finite number
  std::vector<std::string> allowed;
  std::vector<std::string> later;  ///< words reserved for a later version
  std::string about;

  // Contents of this one document.
  bool present = false;
  std::string word;  ///< as read, for kinds `text` and `choice`
};

/// Every key that the readers of a document requested, in the order of the requests. TableReader::has() alone adds no record.
struct KeyLog {
  std::vector<KeyInfo> keys;

  /// Adds a record. If a key is requested twice (or in each element of an array of tables), the first record stays, unless the second has
  /// more information: an `about`, or a choice of words where the first has plain text.
  void note(KeyInfo info);
};

// Make the record of one read. The reader adds table, key, unit and presence.
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

/// @returns the unit in the suffix of a key in printed form: "coupling_N_s_per_m" -> "N s/m", "rate_hz" -> "Hz"; empty if there is none.
[[nodiscard]] std::string unit_of(std::string_view key);

}  // namespace burrhole
