/// core/config/toml_parsed.h: wrapper of toml++ behind toml.h: files, parsing, assignments, places. Only toml*.cpp may include it.
///   Errors  bad_input with the place as "file:line:column", file or "--set path".
#pragma once

#include <toml++/toml.h>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/config/renamed_keys.h"

namespace burrhole::toml_wrapper {

/// A change of a document, as given.
struct Assignment {
  std::string text;    ///< "table.key=value"; "table" or "table.key" of a removal
  std::string option;  ///< the option of the program that gave it, for places
  bool removes = false;
};

/// One parsed text and the assignments applied to it. Immutable once shared with readers.
struct ParsedFile {
  std::string file;
  std::string text;
  std::vector<Assignment> assignments;                       ///< in order
  std::vector<std::string> overridden;                       ///< dotted paths that the assignments wrote
  std::string option;                                        ///< of the last assignment that is no removal
  std::vector<std::pair<std::size_t, RenamedKeys>> renames;  ///< tables applied, each after that many assignments
  toml::table root;
};

/// @returns "path.key", safe to print.
[[nodiscard]] std::string join(const std::string& path, std::string_view key);

/// @returns "file:line:column", or "OPTION path" for a value that an assignment changed or created.
[[nodiscard]] std::string place_at(const ParsedFile& parsed, const std::string& path, const toml::source_region& where);

/// Parses text; toml++ exceptions are converted to errors. `file` is the name in places.
[[nodiscard]] Result<toml::table> parse_table(std::string_view text, const std::string& file);

/// Applies "table.key[2].key=value" to parsed.root and creates missing tables. After an error `parsed` may contain empty new tables and
/// must be discarded. "region.NAME.key" is the element of an array of tables whose key `name` has that value; a blank in it is written as "_" or
/// "-", or the name in quotes. A removal of what is not there is an error.
[[nodiscard]] Status assign(ParsedFile& parsed, const Assignment& assignment);

/// Brings the keys of a table to those of `table`. @returns what was renamed.
[[nodiscard]] std::vector<Renaming> rename(toml::table& root, RenamedKeys table);

}  // namespace burrhole::toml_wrapper
