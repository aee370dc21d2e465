#include "app/scene/schema_doc.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>
#include <tuple>

#include "app/effect/registry.h"
#include "app/scene/markdown.h"
#include "volumes/phantom/phantom_spec.h"

namespace burrhole {
namespace {

bool is_table(const KeyInfo& info) { return info.kind == KeyKind::table || info.kind == KeyKind::tables; }
bool has_word(const KeyInfo& info) { return info.kind == KeyKind::text || info.kind == KeyKind::choice; }

/// The fields of a key that a row shows, without those of one document (present, word).
auto as_documented(const KeyInfo& k) {
  return std::tie(k.table, k.key, k.kind, k.count, k.unit, k.fallback, k.range, k.allowed, k.later, k.about);
}

/// @returns the path of the table that a key of kind table or tables opens.
std::string opened_path(const KeyInfo& info) {
  return (info.table.empty() ? "" : info.table + ".") + info.key + (info.kind == KeyKind::tables ? "[]" : "");
}

const KeyInfo* find(const KeyLog& log, const std::string& table, const std::string& key) {
  for (const KeyInfo& info : log.keys)
    if (info.table == table && info.key == key) return &info;
  return nullptr;
}

bool visits(const KeyLog& log, const std::string& table) {
  return std::any_of(log.keys.begin(), log.keys.end(), [&](const KeyInfo& info) { return info.table == table; });
}

using Rows = std::vector<SchemaRow>;

Rows::iterator row_of(Rows& rows, const KeyInfo& info) {
  return std::find_if(rows.begin(), rows.end(), [&](const SchemaRow& row) { return as_documented(row.key) == as_documented(info); });
}

/// @returns the rows of all logs in the order of reading, the first sample's rows first. A row that only a later sample has is inserted
/// before the next row that this sample shares with earlier ones.
Rows collect_rows(std::span<const KeyLog> logs) {
  Rows rows;
  for (std::size_t n = 0; n < logs.size(); ++n) {
    const std::vector<KeyInfo>& keys = logs[n].keys;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      auto at = row_of(rows, keys[i]);
      if (at == rows.end()) {
        for (std::size_t next = i + 1; next < keys.size() && at == rows.end(); ++next) at = row_of(rows, keys[next]);
        at = rows.insert(at, SchemaRow{keys[i], {}, {}});
      }
      at->samples.push_back(n);
    }
  }
  return rows;
}

/// Values of one key in the samples that have a row, and in those that do not. It determines the condition if no value is in both.
struct Split {
  std::set<std::string> with, without;
  /// Whether the key is merely read in one case and not in the other: that says nothing of its value.
  [[nodiscard]] bool is_presence() const { return with.contains("") || (with.size() > 1 && without.size() == 1 && without.contains("")); }
  [[nodiscard]] bool explains() const {
    return !with.empty() && !without.empty() &&
           std::none_of(with.begin(), with.end(), [&](const std::string& word) { return without.contains(word); });
  }
};

/// @returns the words of `key` of `table` in the samples that visit the row's table; the empty word if a sample does not read the key.
Split split_by(std::span<const KeyLog> logs, const SchemaRow& row, const std::string& table, const std::string& key) {
  Split split;
  for (std::size_t n = 0; n < logs.size(); ++n) {
    if (!visits(logs[n], row.key.table)) continue;
    const KeyInfo* info = find(logs[n], table, key);
    const bool asked = std::find(row.samples.begin(), row.samples.end(), n) != row.samples.end();
    const std::string word = info == nullptr ? std::string() : is_table(*info) ? (info->present ? "there" : "") : info->word;
    (asked ? split.with : split.without).insert(word);
  }
  return split;
}

std::string listed(const std::set<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + markdown_code(word);
  return out;
}

/// @returns "only with A = .. and B = ..": two keys of the row's own table that together determine in which samples it is read; empty if no
/// two do.
std::string two_conditions(std::span<const KeyLog> logs, const SchemaRow& row, const Rows& rows) {
  std::vector<std::pair<std::string, std::set<std::string>>> choices;
  for (const SchemaRow& other : rows)
    if (other.key.table == row.key.table && other.key.key != row.key.key && has_word(other.key)) {
      Split split = split_by(logs, row, other.key.table, other.key.key);
      if (!split.is_presence()) choices.emplace_back(other.key.key, std::move(split.with));
    }
  const auto holds = [&](std::size_t sample, const auto& choice) {
    const KeyInfo* info = find(logs[sample], row.key.table, choice.first);
    return info != nullptr && choice.second.contains(info->word);
  };
  for (std::size_t a = 0; a < choices.size(); ++a)
    for (std::size_t b = a + 1; b < choices.size(); ++b) {
      bool explains = true;
      for (std::size_t n = 0; n < logs.size() && explains; ++n) {
        const bool asked = std::find(row.samples.begin(), row.samples.end(), n) != row.samples.end();
        explains = !visits(logs[n], row.key.table) || asked == (holds(n, choices[a]) && holds(n, choices[b]));
      }
      if (explains)
        return fmt::format("only with {} = {} and {} = {}", markdown_code(choices[a].first), listed(choices[a].second),
                           markdown_code(choices[b].first), listed(choices[b].second));
    }
  return {};
}

/// @returns "only with A = a, b, or c with B = d": a key of the row's own table whose value determines the condition except for one value, with
/// which another key does; empty if there are no such keys.
std::string nested_condition(std::span<const KeyLog> logs, const SchemaRow& row, const Rows& rows) {
  const auto is_other = [&](const SchemaRow& other) {
    return other.key.table == row.key.table && other.key.key != row.key.key && has_word(other.key);
  };
  for (const SchemaRow& outer : rows) {
    if (!is_other(outer)) continue;
    Split split = split_by(logs, row, outer.key.table, outer.key.key);
    std::vector<std::string> both;
    std::ranges::set_intersection(split.with, split.without, std::back_inserter(both));
    if (both.size() != 1 || both.front().empty() || split.with.contains("") || split.with.size() < 2) continue;
    std::vector<KeyLog> inside;
    SchemaRow inner_row{row.key, {}, {}};
    for (std::size_t n = 0; n < logs.size(); ++n) {
      const KeyInfo* info = find(logs[n], outer.key.table, outer.key.key);
      if (info == nullptr || info->word != both.front()) continue;
      if (std::ranges::find(row.samples, n) != row.samples.end()) inner_row.samples.push_back(inside.size());
      inside.push_back(logs[n]);
    }
    for (const SchemaRow& inner : rows) {
      if (!is_other(inner) || inner.key.key == outer.key.key) continue;
      const Split part = split_by(inside, inner_row, inner.key.table, inner.key.key);
      if (!part.explains() || part.is_presence()) continue;
      split.with.erase(both.front());
      return fmt::format("only with {} = {}, or {} with {} = {}", markdown_code(outer.key.key), listed(split.with),
                         markdown_code(both.front()), markdown_code(inner.key.key), listed(part.with));
    }
  }
  return {};
}

/// @returns "only without A and B": keys of the row's own table, one of which is in each sample that does not read the row and none in the
/// others; empty if there are no such keys.
std::string absent_keys(std::span<const KeyLog> logs, const SchemaRow& row, const Rows& rows) {
  std::vector<std::string> keys;
  std::set<std::size_t> explained;
  for (const SchemaRow& other : rows) {
    if (other.key.table != row.key.table || other.key.key == row.key.key || !has_word(other.key)) continue;
    std::set<std::size_t> there;
    for (std::size_t n = 0; n < logs.size(); ++n)
      if (const KeyInfo* info = find(logs[n], other.key.table, other.key.key); info != nullptr && !info->word.empty()) there.insert(n);
    if (there.empty() || std::any_of(row.samples.begin(), row.samples.end(), [&](std::size_t n) { return there.contains(n); })) continue;
    keys.push_back(markdown_code(other.key.key));
    explained.insert(there.begin(), there.end());
  }
  const auto visitors = std::count_if(logs.begin(), logs.end(), [&](const KeyLog& log) { return visits(log, row.key.table); });
  const bool all = explained.size() + row.samples.size() == static_cast<std::size_t>(visitors);
  return all ? fmt::format("only without {}", fmt::join(keys, " and ")) : std::string();
}

std::string condition_of(std::span<const KeyLog> logs, std::span<const std::string> names, const SchemaRow& row, const Rows& rows) {
  const auto visitors = std::count_if(logs.begin(), logs.end(), [&](const KeyLog& log) { return visits(log, row.key.table); });
  if (static_cast<std::size_t>(visitors) == row.samples.size()) return {};
  // A key of the row's own table explains more than one at the top of the file, so it is tried first.
  for (const std::string& table : {row.key.table, std::string()})
    for (const SchemaRow& other : rows) {
      if (other.key.table != table || (other.key.table == row.key.table && other.key.key == row.key.key)) continue;
      if (!has_word(other.key) && !is_table(other.key)) continue;
      const Split split = split_by(logs, row, table, other.key.key);
      if (!split.explains() || (!is_table(other.key) && split.is_presence())) continue;
      if (is_table(other.key))
        return (split.with.contains("there") ? "only with " : "only without ") + markdown_code("[" + other.key.key + "]");
      const bool few = split.with.size() <= split.without.size() || split.without.contains("");
      return fmt::format("{} with {} = {}", few ? "only" : "not", markdown_code(other.key.key), listed(few ? split.with : split.without));
    }
  if (std::string both = two_conditions(logs, row, rows); !both.empty()) return both;
  if (std::string nested = nested_condition(logs, row, rows); !nested.empty()) return nested;
  if (std::string without = absent_keys(logs, row, rows); !without.empty()) return without;
  std::set<std::string> with, without;
  for (std::size_t n = 0; n < logs.size(); ++n)
    if (visits(logs[n], row.key.table))
      (std::find(row.samples.begin(), row.samples.end(), n) != row.samples.end() ? with : without).insert(names[n]);
  if (std::ranges::any_of(with, [&](const std::string& name) { return without.contains(name); })) return {};  // the names explain nothing
  if (with == std::set<std::string>{row.key.key}) return {};  // the key is its own condition: its text says when it is given
  return with.size() <= without.size() ? "only with " + listed(with) : "not with " + listed(without);
}

std::vector<std::string> find_unvisited(std::span<const KeyLog> logs, const Rows& rows) {
  std::vector<std::string> out;
  for (const SchemaRow& row : rows) {
    const std::string path = opened_path(row.key);
    if (is_table(row.key) && std::none_of(logs.begin(), logs.end(), [&](const KeyLog& log) { return visits(log, path); }))
      out.push_back("no sample has the table " + path);
    for (const std::string& word : row.key.allowed) {
      const bool seen = std::any_of(logs.begin(), logs.end(), [&](const KeyLog& log) {
        const KeyInfo* info = find(log, row.key.table, row.key.key);
        return info != nullptr && info->word == word;
      });
      if (!seen) out.push_back(fmt::format("no sample says {} = \"{}\"", path, word));
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// ---- Markdown ----

std::string quoted_words(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + markdown_code('"' + word + '"');
  return out;
}

std::string value_text(const KeyInfo& info) {
  if (info.kind == KeyKind::choice) return quoted_words(info.allowed);
  std::string out(name_of(info.kind));
  if (info.kind == KeyKind::numbers) out = fmt::format("{} numbers{}", info.count, info.range.empty() ? "" : ", each");
  if (info.kind == KeyKind::number && !info.range.empty()) out.clear();
  if (!info.range.empty())
    out += (out.empty() ? "" : " ") + (out.empty() || info.kind == KeyKind::numbers ? "" : std::string("in ")) + info.range;
  return markdown_text(info.unit.empty() ? out : out + " " + info.unit);
}

std::string default_text(const KeyInfo& info) {
  if (info.fallback == kRequiredKey) return "**required**";
  return info.fallback == kNoDefault ? std::string(kNoDefault) : markdown_code(info.fallback);
}

std::string row_text(const SchemaRow& row) {
  std::string about = markdown_text(row.key.about);
  if (!row.key.later.empty()) about += "; not in this version: " + quoted_words(row.key.later);
  if (!row.condition.empty()) about += "; *" + row.condition + "*";
  return fmt::format("| {} | {} | {} | {} |\n", markdown_code(row.key.key), value_text(row.key), default_text(row.key), about);
}

/// "volume" -> "[volume]", "region[]" -> "[[region]]".
std::string header_of(std::string path) {
  const bool array = path.ends_with("[]");
  if (array) path.resize(path.size() - 2);
  return array ? "[[" + path + "]]" : "[" + path + "]";
}

std::string section(const Schema& schema, const std::string& path) {
  std::string out;
  for (const SchemaRow& row : schema.rows)
    if (row.key.table == path && !is_table(row.key)) out += row_text(row);
  return out.empty() ? out : "| key | value | default | what it is |\n|---|---|---|---|\n" + out;
}

/// @returns a note on a table that does not fit into the description of one key.
std::string note_on(const std::string& path) {
  if (path != "volume") return {};
  std::string phantoms;
  for (const std::string& name : phantom_names()) phantoms += (phantoms.empty() ? "" : ", ") + markdown_code(name);
  return " The phantoms are " + phantoms +
         ": generated bone whose exact shape is known. `SCAN` stands for any file or folder: a scan, a mesh, or a bone model, which is "
         "used without conversion.";
}

/// @returns the sections of the tables inside `path`, in the order of reading.
std::string inner_sections(const Schema& schema, const std::string& path) {
  std::string out;
  for (const SchemaRow& row : schema.rows) {
    if (row.key.table != path || !is_table(row.key)) continue;
    std::string about = row.key.about;
    if (!about.empty() && about[0] >= 'a' && about[0] <= 'z') about[0] = static_cast<char>(about[0] - 'a' + 'A');
    const std::string condition = row.condition.empty() ? "" : " *" + row.condition + "*.";
    out += fmt::format("\n## {}\n{}.{}{}\n\n", markdown_code(header_of(opened_path(row.key))), markdown_text(about), condition,
                       note_on(opened_path(row.key)));
    out += section(schema, opened_path(row.key)) + inner_sections(schema, opened_path(row.key));
  }
  return out;
}

constexpr const char* kSceneHead = R"(# Scene files

A scene is one TOML file: the bone, the tool, the approach, the hand, and one table for each effect. **An effect exists if, and only if, the
file has its table**; an empty table takes the defaults. Lengths are in millimetres and angles in degrees; a key with a unit has it in its
name. Ranges are intervals: a round bracket excludes the end. An unknown key is an error, and the message suggests the nearest known key.
`burrhole check SCENE` prints every error with its line; `--set table.key=value` overrides a key for one run.

`burrhole docs scene` generates this page from the rules that read scenes.

## An example
)";
constexpr const char* kToolHead = R"(# Tool files

A tool is one TOML file: primitives stacked along the axis of the drill, each with the rate at which it removes bone. Tool frame: the tip is
the origin, +z runs up the shaft. The regions must form one connected body. The contact points and the erosion points are sampled from them.
Lengths are in millimetres; a key with a unit has it in its name. Ranges are intervals: a round bracket excludes the end. A scene refers to
a tool by name; `burrhole tools FILE` prints the result of sampling.

`burrhole docs tool` generates this page from the rules that read tools.

## An example
)";

constexpr const char* kRawHead = R"(# Raw volumes

A TOML file describes voxels that are stored without a header. `burrhole import` and a scene's `[volume] source` take that file in place of
the data. Paths are relative to it. The sizes of the data files are checked: too few or too many bytes are an error. Ranges are intervals: a
round bracket excludes the end.

`burrhole docs raw` generates this page from the rules that read such files.

## An example
)";

const char* head_of(SchemaFile file) { return file == SchemaFile::scene ? kSceneHead : file == SchemaFile::tool ? kToolHead : kRawHead; }

}  // namespace

Schema merge_logs(std::span<const KeyLog> logs, std::span<const std::string> names) {
  Schema schema;
  schema.rows = collect_rows(logs);
  schema.unvisited = find_unvisited(logs, schema.rows);
  for (SchemaRow& row : schema.rows) row.condition = condition_of(logs, names, row, schema.rows);
  return schema;
}

std::string schema_markdown(SchemaFile file) {
  std::vector<KeyLog> logs;
  std::vector<std::string> names;
  for (const SchemaSample& sample : schema_samples(file)) {
    logs.push_back(read_sample(file, sample.text).log);
    names.push_back(sample.name);
  }
  const Schema schema = merge_logs(logs, names);
  std::string out = head_of(file);
  out += "```toml\n" + schema_example(file) + "```\n\n## Top of the file\n\n" + section(schema, "") + inner_sections(schema, "");
  return out;
}

std::vector<std::string> documented_keys(const std::string& markdown) {
  std::vector<std::string> keys;
  std::string table;
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) table.clear();
    if (line.starts_with("## `[[")) table = line.substr(6, line.find(']') - 6) + "[].";
    if (line.starts_with("## `[") && !line.starts_with("## `[[")) table = line.substr(5, line.find(']') - 5) + ".";
    if (line.starts_with("| `")) keys.push_back(table + line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

}  // namespace burrhole
