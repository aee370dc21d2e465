// docs/scene.md and docs/tool.md say what the readers ask for: neither less nor anything else.
#include "app/scene/schema_doc.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "app/scene/scene.h"
#include "core/tool/tool_spec.h"
#include "tests/support/source_folder.h"

using namespace burrhole;
namespace fs = std::filesystem;

namespace {

const fs::path kSource = test::in_source("");

std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

struct Format {
  SchemaFile file;
  const char* name;
};
constexpr Format kFormats[] = {{SchemaFile::scene, "scene"}, {SchemaFile::tool, "tool"}, {SchemaFile::raw, "raw"}};

struct Logs {
  std::vector<KeyLog> logs;
  std::vector<std::string> names;
};
Logs read_samples(SchemaFile file) {
  Logs out;
  for (const SchemaSample& sample : schema_samples(file)) {
    out.logs.push_back(read_sample(file, sample.text).log);
    out.names.push_back(sample.name);
  }
  return out;
}

/// TOML files of a format: all that are shipped, and those of the tests. A scene has bone, a raw volume has dims, the rest are tools.
std::vector<fs::path> files_of(SchemaFile wanted) {
  std::vector<fs::path> found;
  for (const char* folder : {"app/scenes", "app/scenes/volumes", "app/tools", "tests/data/scenes"})
    for (const auto& entry : fs::directory_iterator(kSource / folder)) {
      if (entry.path().extension() != ".toml") continue;
      Issues issues;
      const auto document = TomlDocument::load(entry.path().string());
      REQUIRE_MESSAGE(document.ok(), entry.path().string());
      const TableReader root = document->root(issues);
      const SchemaFile format = root.has("volume") ? SchemaFile::scene : root.has("dims") ? SchemaFile::raw : SchemaFile::tool;
      if (format == wanted) found.push_back(entry.path());
    }
  std::sort(found.begin(), found.end());
  return found;
}

/// "table.key" of everything a file holds, found without any reader of the format; tables themselves are left out.
void collect_keys(TableReader table, std::set<std::string>& keys) {
  Issues ignored;
  for (const std::string& key : table.keys()) {
    const std::string path = without_indices(table.name());
    if (auto sub = table.table(key, "")) {
      collect_keys(*sub, keys);
    } else if (const auto parts = table.tables(key, ""); !parts.empty()) {
      for (const TableReader& part : parts) collect_keys(part, keys);
    } else {
      keys.insert(path.empty() ? key : path + "." + key);
    }
  }
}
std::set<std::string> keys_in(const fs::path& path) {
  const auto document = TomlDocument::load(path.string());
  REQUIRE(document.ok());
  Issues ignored;
  std::set<std::string> keys;
  collect_keys(document->root(ignored), keys);
  return keys;
}

/// Keys that a reader asks this file for.
std::set<std::string> keys_asked(SchemaFile file, const fs::path& path) {
  std::set<std::string> keys;
  for (const KeyInfo& info : read_sample(file, read(path)).log.keys)
    if (info.kind != KeyKind::table && info.kind != KeyKind::tables) keys.insert((info.table.empty() ? "" : info.table + ".") + info.key);
  return keys;
}

std::vector<std::string> missing(const std::set<std::string>& keys, const std::string& markdown) {
  const std::vector<std::string> known = documented_keys(markdown);
  std::vector<std::string> out;
  for (const std::string& key : keys)
    if (std::find(known.begin(), known.end(), key) == known.end()) out.push_back(key);
  return out;
}

const SchemaRow* find_row(const Schema& schema, const std::string& table, const std::string& key) {
  for (const SchemaRow& row : schema.rows)
    if (row.key.table == table && row.key.key == key) return &row;
  return nullptr;
}

}  // namespace

TEST_CASE("reference: docs/scene.md and docs/tool.md are what the program prints") {
  for (const Format& format : kFormats) {
    const fs::path path = kSource / "docs" / (std::string(format.name) + ".md");
    const bool same = read(path) == schema_markdown(format.file);
    CHECK_MESSAGE(same, path.string() << " is out of date; run: burrhole docs " << format.name << " > docs/" << format.name << ".md");
  }
}

TEST_CASE("reference: every key of every shipped file and of the tests' files is in it") {
  for (const Format& format : kFormats) {
    const std::string markdown = schema_markdown(format.file);
    const std::vector<fs::path> files = files_of(format.file);
    REQUIRE(!files.empty());
    for (const fs::path& path : files) {
      CAPTURE(path.string());
      const std::set<std::string> written = keys_in(path), asked = keys_asked(format.file, path);
      CHECK(written.size() >= 5);  // the smallest has more: an empty set would pass unseen
      CHECK(asked.size() >= written.size());
      CHECK(missing(written, markdown) == std::vector<std::string>{});
      CHECK(missing(asked, markdown) == std::vector<std::string>{});
    }
  }
}

TEST_CASE("sabotage: a row taken out of the reference is missed") {
  std::string markdown = schema_markdown(SchemaFile::scene);
  const std::size_t at = markdown.find("| `spin_rpm` |");
  REQUIRE(at != std::string::npos);
  markdown.erase(at, markdown.find('\n', at) + 1 - at);
  const fs::path parietal = kSource / "app/scenes/parietal.toml";
  CHECK(missing(keys_in(parietal), markdown) == std::vector<std::string>{"tool.spin_rpm"});
  CHECK(missing(keys_asked(SchemaFile::scene, parietal), markdown) == std::vector<std::string>{"tool.spin_rpm"});
}

TEST_CASE("reference: its samples are sound, each as its line says") {
  for (const Format& format : kFormats)
    for (const SchemaSample& sample : schema_samples(format.file)) {
      CAPTURE(sample.name);
      const ReadSample got = read_sample(format.file, sample.text);
      std::string told;
      for (const Error& issue : got.issues) told += issue.text() + "\n";
      CAPTURE(told);
      REQUIRE(got.issues.size() == (sample.expected_error.empty() ? 0u : 1u));
      if (!sample.expected_error.empty()) CHECK(got.issues[0].message.find(sample.expected_error) != std::string::npos);
    }
}

TEST_CASE("reference: its examples are sound, and the scene's tool is a shipped one") {
  for (const Format& format : kFormats) {
    const ReadSample got = read_sample(format.file, schema_example(format.file));
    CHECK_MESSAGE(got.issues.empty(), (got.issues.empty() ? "" : got.issues[0].text()));
  }
  const auto document = TomlDocument::parse(schema_example(SchemaFile::scene), "example.toml");
  REQUIRE(document.ok());
  Issues issues;
  CHECK(read_scene(*document, {.tool_folders = {(kSource / "app/tools").string()}}, issues));
}

TEST_CASE("reference: the samples reach every word of every choice and every table") {
  for (const Format& format : kFormats) {
    const Logs all = read_samples(format.file);
    for (const std::string& line : merge_logs(all.logs, all.names).unvisited) FAIL_CHECK(line);
  }
}

TEST_CASE("sabotage: a branch without a sample is found") {
  // Each is the only sample of its word.
  const std::pair<SchemaFile, const char*> only[] = {{SchemaFile::scene, "[erosion] law = \"per-update\""},
                                                     {SchemaFile::tool, "ellipsoid"}};
  for (const auto& [file, name] : only) {
    Logs all = read_samples(file);
    const auto at = std::find(all.names.begin(), all.names.end(), name);
    REQUIRE(at != all.names.end());
    all.logs.erase(all.logs.begin() + (at - all.names.begin()));
    all.names.erase(at);
    const std::vector<std::string> unvisited = merge_logs(all.logs, all.names).unvisited;
    REQUIRE(unvisited.size() == 1);
    CHECK(unvisited[0].starts_with("no sample says "));
  }
  KeyLog log = read_sample(SchemaFile::tool, schema_samples(SchemaFile::tool)[0].text).log;
  std::erase_if(log.keys, [](const KeyInfo& info) { return info.table == "shell"; });
  const std::vector<KeyLog> logs{log};
  const std::vector<std::string> names{"cylinder"};
  const std::vector<std::string> found = merge_logs(logs, names).unvisited;
  CHECK(std::find(found.begin(), found.end(), "no sample has the table shell") != found.end());
}

TEST_CASE("reference: a key of some branches says which") {
  const Logs scenes = read_samples(SchemaFile::scene), tools = read_samples(SchemaFile::tool);
  const Schema scene = merge_logs(scenes.logs, scenes.names), tool = merge_logs(tools.logs, tools.names);
  const auto condition = [](const Schema& schema, const char* table, const char* key) {
    const SchemaRow* row = find_row(schema, table, key);
    REQUIRE_MESSAGE(row != nullptr, key);
    return row->condition;
  };
  CHECK(condition(scene, "volume", "wedge_deg") == "only with `source` = `phantom:wedge`");
  CHECK(condition(scene, "volume", "source") == "");
  CHECK(condition(scene, "contact", "mode") == "only with `model` = `gradient-plane`, `voxmap`");
  CHECK(condition(scene, "contact", "storage") == "only with `model` = `gradient-plane`");
  CHECK(condition(scene, "contact", "mass_kg") == "only with `coupling` = `virtual`");
  CHECK(condition(scene, "contact", "rate_hz") == "");
  CHECK(condition(scene, "erosion", "cutting_ratio") == "only with `law` = `energy`, `progressive`");
  CHECK(condition(scene, "erosion", "subvoxel") == "only with `law` = `energy`, `rate`");
  CHECK(condition(scene, "spindle", "stall_torque_Nm") == "");
  CHECK(condition(tool, "region[]", "top_diameter_mm") == "only with `shape` = `frustum`");
  CHECK(condition(tool, "region[]", "z_mm") == "");
}

TEST_CASE("reference: conditions by a table that is there, and by name where no word explains") {
  const auto key = [](const char* table, const char* name, KeyKind kind, bool present) {
    KeyInfo info;
    info.table = table;
    info.key = name;
    info.kind = kind;
    info.present = present;
    return info;
  };
  KeyLog with, without;
  with.keys = {key("", "mesh", KeyKind::table, true), key("", "unit_mm", KeyKind::number, true), key("mesh", "file", KeyKind::text, true)};
  without.keys = {key("", "mesh", KeyKind::table, false)};
  const std::vector<KeyLog> logs{with, without};
  const std::vector<std::string> names{"mesh", "plain"};
  const Schema schema = merge_logs(logs, names);
  CHECK(find_row(schema, "", "unit_mm")->condition == "only with `[mesh]`");
  CHECK(find_row(schema, "mesh", "file")->condition == "");  // every sample that has the table has it

  KeyLog first, second;
  first.keys = {key("", "a", KeyKind::number, true)};
  second.keys = {key("", "b", KeyKind::number, true)};
  const std::vector<KeyLog> other{first, second};
  CHECK(find_row(merge_logs(other, names), "", "a")->condition == "only with `mesh`");
  const std::vector<std::string> of_the_key{"a", "plain"};
  CHECK(find_row(merge_logs(other, of_the_key), "", "a")->condition == "");  // its own condition
  const std::vector<std::string> alike{"plain", "plain"};
  CHECK(find_row(merge_logs(other, alike), "", "a")->condition == "");  // a name of both says nothing
}

TEST_CASE("reference: one key read by two rules has two rows") {
  KeyLog first = read_sample(SchemaFile::tool, schema_samples(SchemaFile::tool)[0].text).log;
  KeyLog second = first;
  for (KeyInfo& info : second.keys)
    if (info.key == "z_mm") info.range = "[0, 5]";
  const std::vector<KeyLog> logs{first, second};
  const std::vector<std::string> names{"first", "second"};
  const Schema schema = merge_logs(logs, names);
  CHECK(std::count_if(schema.rows.begin(), schema.rows.end(), [](const SchemaRow& row) { return row.key.key == "z_mm"; }) == 2);
}

TEST_CASE("reference: the keys of a printed page are found again with their tables") {
  const std::string page =
      "# T\n\n## Top of the file\n\n| key | value |\n|---|---|\n| `title` | text |\n\n## `[volume]`\nA.\n\n| `a_mm` | x |\n"
      "\n## `[[region]]`\n\n| `shape` | x |\n\n## Notes\n\n| `loose` | x |\n";
  CHECK(documented_keys(page) == std::vector<std::string>{"title", "volume.a_mm", "region[].shape", "loose"});
}
