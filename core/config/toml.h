/// core/config/toml.h: TOML input with the location of every value. toml++ is used behind toml_parsed.h only.
///   A reader requests each key of a table with its rule. A key that no reader requests is an error that names the nearest requested key.
///   Units  as each NumberRule states; values are converted to SI.   Frame  none.
///   Errors  readers push an Error with file:line:column to Issues; load(), parse() and set() return bad_input.   Thread  one owner.
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
#include "core/config/renamed_keys.h"

namespace burrhole {

struct KeyLog;

/// Every error found, in the order of the reads; empty means valid.
using Issues = std::vector<Error>;

/// Range and conversion of a number in a file. `to_si` multiplies the number as written.
struct NumberRule {
  std::optional<double> fallback = std::nullopt;          ///< [unit of the file] value of an absent key; nothing: the key is required
  double min = -std::numeric_limits<double>::infinity();  ///< [unit of the file]
  double max = std::numeric_limits<double>::infinity();   ///< [unit of the file]
  bool min_open = false;                                  ///< `min` itself is excluded
  bool max_open = false;                                  ///< `max` itself is excluded
  double to_si = 1.0;                                     ///< [SI unit / unit of the file] factor
};

class TomlDocument;

/// One table of a document. Cheap to copy; keeps its document alive. Reads push errors to the Issues given at creation.
class TableReader {
 public:
  [[nodiscard]] bool has(std::string_view key) const;              ///< counts as a request of the key
  [[nodiscard]] std::string name() const;                          ///< dotted path, empty for the root
  [[nodiscard]] std::string place() const;                         ///< location of the table itself
  [[nodiscard]] std::string place_of(std::string_view key) const;  ///< location of the key, or of the table if the key is absent

  // Reads. On an error they push an issue and return the fallback (or a value inside the rule), so that reading continues.
  double number(std::string_view key, const NumberRule& rule, std::string_view about);
  std::int64_t integer(std::string_view key, std::optional<std::int64_t> fallback, std::int64_t min, std::int64_t max,
                       std::string_view about);
  bool boolean(std::string_view key, bool fallback, std::string_view about);
  std::string text(std::string_view key, std::optional<std::string> fallback, std::string_view about);
  /// One of `allowed`. Another word is an issue that names the nearest allowed word. `later` are words reserved for a later version; the
  /// issue says so.
  std::string choice(std::string_view key, std::optional<std::string> fallback, const std::vector<std::string>& allowed,
                     std::string_view about, const std::vector<std::string>& later = {});
  /// Exactly `count` finite numbers within the rule, converted to SI.
  std::vector<double> numbers(std::string_view key, std::optional<std::vector<double>> fallback, std::size_t count, const NumberRule& rule,
                              std::string_view about);
  Vec3 vector(std::string_view key, std::optional<Vec3> fallback, const NumberRule& rule, std::string_view about);

  // Reads of keys whose absence disables a feature: an absent key returns nothing and is not an issue.
  std::optional<double> optional_number(std::string_view key, const NumberRule& rule, std::string_view about);
  std::optional<std::vector<double>> optional_numbers(std::string_view key, std::size_t count, const NumberRule& rule,
                                                      std::string_view about);
  std::optional<std::string> optional_choice(std::string_view key, const std::vector<std::string>& allowed, std::string_view about);

  /// Sub-table, or nothing if absent (an issue if the key holds another type). Counts as a request of the key.
  std::optional<TableReader> table(std::string_view key, std::string_view about);
  /// Elements of an array of tables ([[key]]); empty if absent.
  std::vector<TableReader> tables(std::string_view key, std::string_view about);
  /// Key names in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Pushes an issue at a key of this table.
  void fault(std::string_view key, const std::string& message);
  /// Pushes an issue for each key that was not requested: it names the nearest key, or the full name if only the unit suffix is missing.
  void finish();

 private:
  friend class TomlDocument;
  struct State;
  explicit TableReader(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// A change of a document, as given: see TomlDocument::set() and unset().
struct TomlChange {
  std::string text;
  std::string option = "--set";
  bool removes = false;
};

/// A parsed file. Does not throw; toml++ exceptions are converted to errors.
class TomlDocument {
 public:
  [[nodiscard]] static Result<TomlDocument> load(const std::string& path);
  [[nodiscard]] static Result<TomlDocument> parse(std::string_view text, const std::string& file_name);
  /// Applies "table.key=value" (value in TOML syntax; a bare word or path is taken as text). Creates missing tables. "region[1].key" names
  /// an element of an array of tables, from 0, and "region.NAME.key" the element whose key `name` has that value. Places of such values
  /// read "OPTION table.key". Existing readers and copies keep the old values.
  [[nodiscard]] Status set(std::string_view assignment, const std::string& option = "--set");
  /// Removes a table or a key. bad_input: it is not there.
  [[nodiscard]] Status unset(std::string_view path, const std::string& option = "--unset");
  /// As set() and unset() of each in order, for which the text is parsed once. @returns all errors; after one the document is as it was.
  [[nodiscard]] Issues apply(const std::vector<TomlChange>& changes);
  /// @returns how often the text was parsed for this document and those that it was copied from.
  [[nodiscard]] std::size_t parses() const noexcept;
  /// @returns what set() and unset() were given, in order; a removal as "unset PATH".
  [[nodiscard]] std::vector<std::string> changes() const;
  /// Brings keys of earlier versions to today's names and units. @returns what was renamed, in the order of the table. Later calls of set()
  /// take today's names.
  std::vector<Renaming> rename(RenamedKeys table = renamed_keys());
  /// An unknown key that is in `table` is reported with its new name; the table must outlive every reader. By default renamed_keys().
  void report_renamed(RenamedKeys table);
  /// Reader of the root. It pushes errors to `issues` and a record of each read to `log` if not null; both must outlive every reader.
  [[nodiscard]] TableReader root(Issues& issues, KeyLog* log = nullptr) const;
  [[nodiscard]] const std::string& file_name() const;
  /// The document as TOML text including the assignments (for the session file).
  [[nodiscard]] std::string to_text() const;

 private:
  struct State;
  explicit TomlDocument(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// @returns the candidate with the smallest edit distance, if it is small enough to be a typing error.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace burrhole
