/// app/scene/schema_doc.h: references of the file formats, made of what their readers asked for while they read the samples.
///   docs/scene.md, docs/tool.md and docs/raw.md are this text; a test compares them byte for byte. Thread: any.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/scene/schema_samples.h"

namespace burrhole {

/// One key of the reference. A key that two branches read by different rules has a row each.
struct SchemaRow {
  KeyInfo key;
  std::vector<std::size_t> samples;  ///< indices of the logs that hold it
  std::string condition;             ///< Markdown: "only with source = ...", empty when every sample that has the table asks for it
};

struct Schema {
  std::vector<SchemaRow> rows;  ///< in the order of reading; keys of one table are not always neighbours
  /// Words of choices and tables that no log reached: their own keys would be missing. Text for the author, one line each.
  std::vector<std::string> unvisited;
};

/// Puts logs of several samples together. `names`: of the samples, for conditions that no word of the file explains.
[[nodiscard]] Schema merge_logs(std::span<const KeyLog> logs, std::span<const std::string> names);

/// The whole reference as Markdown, ending in a line break.
[[nodiscard]] std::string schema_markdown(SchemaFile file);

/// "table.key" of every row of a reference as printed, "region[].key" in arrays of tables, "key" at the top of the file.
[[nodiscard]] std::vector<std::string> documented_keys(const std::string& markdown);

}  // namespace burrhole
