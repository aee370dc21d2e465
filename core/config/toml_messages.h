/// core/config/toml_messages.h: texts of located TOML errors. Uses strings and numbers only, not toml++.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/toml.h"

namespace burrhole {

/// @returns text that is safe to print on one line: control characters (also C1, line separators and those of the direction of writing) and
/// bytes that are not UTF-8 are escaped as "\\n", "\\x1b" or "\\u009b"; long text is cut between two characters, with "...".
[[nodiscard]] std::string one_line(std::string_view text, std::size_t max_bytes = 80);

/// @returns a text of many lines that is safe to print: as one_line(), but line feeds and tabulators stay and nothing is cut.
[[nodiscard]] std::string printable_text(std::string_view text);

/// @returns the text in quotes as TOML reads it back, control characters escaped.
[[nodiscard]] std::string toml_string(std::string_view text);

/// @returns the shortest text that reads back as the same number: -5, 0.25, nan.
[[nodiscard]] std::string number_text(double value);

// The numbers of the next three functions are in the unit of the file, before the conversion to SI.

/// @returns the condition of a rule: "must be in (0, 20]", "must be > 0", "must be at least 1"; "must be finite" for a rule without limits.
[[nodiscard]] std::string range_text(const NumberRule& rule);

/// @returns whether a number is finite and inside the range of the rule.
[[nodiscard]] bool within(double written, const NumberRule& rule) noexcept;

/// @returns a number that obeys the rule: the fallback if it does; else the middle of a range with two limits; else the only limit, or the
/// number 1 inside it if the limit is excluded; else 0.
[[nodiscard]] double value_inside(const NumberRule& rule) noexcept;

/// @returns the name in `known` that is `word` plus a unit suffix ("radius" -> "radius_mm"), if there is one.
[[nodiscard]] std::optional<std::string> with_unit(std::string_view word, const std::vector<std::string>& known);

/// @returns the unit suffix of a key with its underscore ("radius_mm" -> "_mm"); empty if it has none.
[[nodiscard]] std::string_view unit_suffix(std::string_view key);

/// For a value that a person wrote with its unit, such as 30s, "5 mm/s" or 28%: @returns what to write; nothing for any other text.
/// @param key dotted path of the key.
[[nodiscard]] std::optional<std::string> number_without_unit(std::string_view key, std::string_view value);

/// @returns `key` without its unit suffix ("radius_mm" -> "radius"), or nothing if it has none.
[[nodiscard]] std::optional<std::string_view> without_unit(std::string_view key);

}  // namespace burrhole
