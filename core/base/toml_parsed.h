/// core/base/toml_parsed.h: the wrapper round toml++ behind toml.h: files, parsing, assignments, places. Included by toml*.cpp alone.
#pragma once

#include <toml++/toml.h>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace burrhole::toml_wrapper {

/// One text parsed, with the assignments made on it afterwards. Never changes once shared with readers.
struct ParsedFile {
  std::string file;
  std::string text;
  std::vector<std::string> assignments;  ///< as given, in order
  std::vector<std::string> overridden;   ///< dotted paths that the assignments wrote
  toml::table root;
};

/// "path.key", safe to print.
[[nodiscard]] std::string join(const std::string& path, std::string_view key);

/// "file:line:column", or "--set path" for what an assignment wrote or made.
[[nodiscard]] std::string place_at(const ParsedFile& parsed, const std::string& path, const toml::source_region& where);

/// Whole file as bytes; an error says why the system refused.
[[nodiscard]] Result<std::string> read_text(const std::string& path);

/// Parses; toml++ exceptions end here. `file` is the name that places show.
[[nodiscard]] Result<toml::table> parse_table(std::string_view text, const std::string& file);

/// Applies "table.key[2].key=value" to parsed.root, making tables as needed. On an error parsed may hold empty new tables: drop it.
[[nodiscard]] Status assign(ParsedFile& parsed, std::string_view assignment);

}  // namespace burrhole::toml_wrapper
