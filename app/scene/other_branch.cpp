#include "app/scene/other_branch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "app/scene/schema_doc.h"

namespace burrhole {
namespace {

Schema schema_of(SchemaFile file) {
  std::vector<KeyLog> logs;
  std::vector<std::string> names;
  for (const SchemaSample& sample : schema_samples(file)) {
    logs.push_back(read_sample(file, sample.text).log);
    names.push_back(sample.name);
  }
  return merge_logs(logs, names);
}

/// "region[0]" -> "region[]", as the rows of a schema name tables.
std::string in_schema(std::string_view path) {
  std::string out(path);
  for (std::size_t at = out.find('['); at != std::string::npos; at = out.find('[', at + 1)) out.erase(at + 1, out.find(']', at) - at - 1);
  return out;
}

/// The words of a TableReader: unknown table [TABLE.KEY].
std::optional<std::pair<std::string, std::string>> unknown_table(const std::string& message) {
  constexpr std::string_view kBefore = "unknown table [";
  if (!message.starts_with(kBefore)) return std::nullopt;
  const std::size_t end = message.find_last_of(']', message.find(';'));
  if (end == std::string::npos) return std::nullopt;
  const std::string path = message.substr(kBefore.size(), end - kBefore.size());
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::pair(std::string(), path) : std::pair(path.substr(0, dot), path.substr(dot + 1));
}

/// The words of a TableReader: unknown key "KEY" in [TABLE]; in a file without tables only the key.
std::optional<std::pair<std::string, std::string>> unknown_key(const std::string& message) {
  constexpr std::string_view kBefore = "unknown key \"", kBetween = "\" in [";
  if (!message.starts_with(kBefore)) return std::nullopt;
  const std::size_t end = message.find('"', kBefore.size());
  if (end == std::string::npos) return std::nullopt;
  const std::string key = message.substr(kBefore.size(), end - kBefore.size());
  if (message.compare(end, kBetween.size(), kBetween) != 0) return std::pair(std::string(), key);
  const std::size_t from = end + kBetween.size(), to = message.find("];", from);
  const std::string path = message.substr(from, to == std::string::npos ? message.size() - 1 - from : to - from);
  return std::pair(path, key);
}

/// A condition of the reference without the marks of Markdown.
std::string plain(std::string text) {
  std::erase_if(text, [](char c) { return c == '`' || c == '\\'; });
  return text;
}

const std::array<Schema, 3>& schemas() {
  static const std::array<Schema, 3> kSchemas{schema_of(SchemaFile::scene), schema_of(SchemaFile::tool), schema_of(SchemaFile::raw)};
  return kSchemas;
}

/// @returns the word after `burrhole docs` of the reference that lists the keys of a table; nothing if none has it.
std::optional<std::string_view> reference_of(const std::string& table) {
  constexpr std::array<std::string_view, 3> kWords{"scene", "tool", "raw"};
  for (std::size_t n = 0; n < kWords.size(); ++n)
    if (std::ranges::any_of(schemas()[n].rows, [&](const SchemaRow& row) { return row.key.table == table; })) return kWords[n];
  return std::nullopt;
}

}  // namespace

std::optional<std::string> when_read(std::string_view path, std::string_view key) {
  const std::string table = in_schema(path);
  for (const Schema& schema : schemas())
    for (const SchemaRow& row : schema.rows)
      if (row.key.table == table && row.key.key == key && !row.condition.empty()) return plain(row.condition);
  return std::nullopt;
}

void explain_unknown_keys(Issues& issues) {
  for (Error& issue : issues) {
    const auto table = unknown_table(issue.message);
    const auto unknown = table ? table : unknown_key(issue.message);
    if (!unknown) continue;
    const auto& [path, key] = *unknown;
    const auto condition = when_read(path, key);
    if (!condition) {
      const auto reference = table || path.empty() || !issue.message.ends_with(']') ? std::nullopt : reference_of(in_schema(path));
      if (reference) issue.message += fmt::format("; burrhole docs {} lists its keys", *reference);
      continue;
    }
    const std::string full = path.empty() ? key : path + "." + key, name = table ? "[" + full + "]" : full;
    const bool not_with = condition->starts_with("not ");
    issue.message = fmt::format("{} is {} {}: remove the {}, or change that choice", name, not_with ? "not read" : "read",
                                not_with ? condition->substr(std::string_view("not ").size()) : *condition, table ? "table" : "key");
  }
}

}  // namespace burrhole
