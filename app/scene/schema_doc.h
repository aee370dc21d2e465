/// app/scene/schema_doc.h: generates the references of the file formats from the keys that the readers request while they read samples.
///   docs/scene.md, docs/tool.md and docs/raw.md are this text; a test compares them byte for byte.   Thread  any.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/scene/schema_samples.h"

namespace burrhole {

/// One key of the reference. A key that two branches of a reader read by different rules has one row for each rule.
struct SchemaRow {
  KeyInfo key;
  std::vector<std::size_t> samples;  ///< indices of the logs that contain it
  std::string condition;             ///< Markdown: "only with source = ..."; empty if it is read in every sample that has the table
};

struct Schema {
  std::vector<SchemaRow> rows;  ///< in the order of reading; keys of one table are not always neighbours
  /// Tables and words of choices that no sample covers, so that their keys are missing; one line each, for the author of the samples.
  std::vector<std::string> unvisited;
};

/// Merges the logs of several samples. @param names of the samples, for conditions that no key of the file determines.
[[nodiscard]] Schema merge_logs(std::span<const KeyLog> logs, std::span<const std::string> names);

/// @returns the whole reference as Markdown, ending in a line break.
[[nodiscard]] std::string schema_markdown(SchemaFile file);

/// @returns "table.key" for every row of a printed reference, "region[].key" in arrays of tables, "key" at the top of the file.
[[nodiscard]] std::vector<std::string> documented_keys(const std::string& markdown);

}  // namespace burrhole
