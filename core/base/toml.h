/// core/base/toml.h: located TOML reading: every fault carries file:line:column; toml++ stays behind toml_parsed.h.
/// A TableReader is asked for each key with its rule; keys nobody asked for are errors that name the nearest key asked for.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct KeyLog;

/// Every fault found, in file order of discovery; empty means valid.
using Issues = std::vector<Error>;

/// What a number in a file must satisfy. `unit` is what the key's suffix says; `to_si` multiplies the number as written.
struct NumberRule {
  std::optional<double> fallback = std::nullopt;  ///< as written in the file (not SI); absent: the key is required
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_open = false;  ///< min itself is not allowed
  bool max_open = false;
  double to_si = 1.0;
};

class TomlDocument;

/// One table of a document. Cheap to copy; keeps its document alive. Reads push faults to the Issues given at creation.
class TableReader {
 public:
  [[nodiscard]] bool has(std::string_view key) const;              ///< counts as asked for
  [[nodiscard]] std::string name() const;                          ///< dotted path, empty for the root
  [[nodiscard]] std::string place() const;                         ///< of the table itself
  [[nodiscard]] std::string place_of(std::string_view key) const;  ///< of the key, or of the table when absent

  // Reads; on a fault an issue is pushed and the fallback (or a value inside the rule) is returned, so reading can go on.
  double number(std::string_view key, const NumberRule& rule, std::string_view about);
  std::int64_t integer(std::string_view key, std::optional<std::int64_t> fallback, std::int64_t min, std::int64_t max,
                       std::string_view about);
  bool boolean(std::string_view key, bool fallback, std::string_view about);
  std::string text(std::string_view key, std::optional<std::string> fallback, std::string_view about);
  /// One of `allowed`; a wrong word is an issue that names the nearest. `later` are words known but not in this version: said so by name.
  std::string choice(std::string_view key, std::optional<std::string> fallback, const std::vector<std::string>& allowed,
                     std::string_view about, const std::vector<std::string>& later = {});
  /// Exactly `count` finite numbers within the rule, converted to SI.
  std::vector<double> numbers(std::string_view key, std::optional<std::vector<double>> fallback, std::size_t count, const NumberRule& rule,
                              std::string_view about);
  Vec3 vector(std::string_view key, std::optional<Vec3> fallback, const NumberRule& rule, std::string_view about);

  // The same for keys whose absence means that there is no such thing: nothing is read, and nothing is missing.
  std::optional<double> optional_number(std::string_view key, const NumberRule& rule, std::string_view about);
  std::optional<std::vector<double>> optional_numbers(std::string_view key, std::size_t count, const NumberRule& rule,
                                                      std::string_view about);
  std::optional<std::string> optional_choice(std::string_view key, const std::vector<std::string>& allowed, std::string_view about);

  /// Sub-table, or nothing when absent (an issue when the key holds something else). Counts as asked for.
  std::optional<TableReader> table(std::string_view key, std::string_view about);
  /// Elements of an array of tables ([[key]]); empty when absent.
  std::vector<TableReader> tables(std::string_view key, std::string_view about);
  /// Key names in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Pushes an issue at a key of this table.
  void fault(std::string_view key, const std::string& message);
  /// Pushes an issue for each key that was never asked for: nearest name; a key that lacks its unit is told the full name.
  void finish();

 private:
  friend class TomlDocument;
  struct State;
  explicit TableReader(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// A parsed file. Throws nothing; toml++ exceptions stop inside.
class TomlDocument {
 public:
  [[nodiscard]] static Result<TomlDocument> load(const std::string& path);
  [[nodiscard]] static Result<TomlDocument> parse(std::string_view text, const std::string& file_name);
  /// Applies "table.key=value" (value in TOML syntax; a bare word or path is taken as text). Makes tables as needed; "region[1].key" names
  /// an element of an array of tables, from 0. Later places read "--set table.key". Readers and copies made before keep the old values.
  [[nodiscard]] Status set(std::string_view assignment);
  /// Reader of the root; faults go to `issues`, and a record of each read to `log` if there is one; both must outlive every reader.
  [[nodiscard]] TableReader root(Issues& issues, KeyLog* log = nullptr) const;
  [[nodiscard]] const std::string& file_name() const;
  /// The document as TOML text with overrides applied (for the session).
  [[nodiscard]] std::string to_text() const;

 private:
  struct State;
  explicit TomlDocument(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// The candidate with the least edit distance, if it is near enough to be a slip of the keyboard.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace burrhole
