// What is said of a key that another choice in the file would read.
#include "app/scene/other_branch.h"

#include <doctest/doctest.h>

#include <string>

#include "app/scene/schema_doc.h"
#include "core/tool/tool_spec.h"

using namespace burrhole;

namespace {

/// The one issue of a hand of that text, explained.
std::string about_hand(const std::string& lines) {
  ReadSample read =
      read_sample(SchemaFile::scene,
                  "[volume]\nsource = \"phantom:plate\"\n[tool]\nname = \"x\"\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n"
                  "[contact]\n[hand]\n" +
                      lines + "\n");
  Issues issues = read.issues;
  explain_unknown_keys(issues);
  REQUIRE(issues.size() == 1);
  return issues.front().message;
}

}  // namespace

TEST_CASE("key of another choice: the condition is that of the reference, for every conditional key of scenes and tools") {
  int conditional = 0;
  for (const SchemaFile file : {SchemaFile::scene, SchemaFile::tool}) {
    std::vector<KeyLog> logs;
    std::vector<std::string> names;
    for (const SchemaSample& sample : schema_samples(file)) {
      logs.push_back(read_sample(file, sample.text).log);
      names.push_back(sample.name);
    }
    for (const SchemaRow& row : merge_logs(logs, names).rows) {
      if (row.condition.empty()) continue;
      ++conditional;
      CHECK_MESSAGE(when_read(row.key.table, row.key.key).has_value(), row.key.table << "." << row.key.key);
    }
  }
  CHECK(conditional > 40);
}

TEST_CASE("key of another choice: names the choice that reads it") {
  CHECK(about_hand("stop_mm = 3") == "hand.stop_mm is read only with kind = feed: remove the key, or change that choice");
  CHECK(about_hand("kind = \"feed\"\nstop_mm = 3\ndetects = true").starts_with("hand.detects is "));
  CHECK(when_read("volume", "seed") == "not with source = SCAN");
  CHECK(when_read("region[12]", "width_mm") == "only with shape = box");
}

TEST_CASE("key of another choice: a key that nobody reads keeps its message, with the nearest name") {
  CHECK(about_hand("pusch_N = 3") == "unknown key \"pusch_N\" in [hand]; did you mean \"push_N\"?");
  CHECK(about_hand("nonsense = 3") == "unknown key \"nonsense\" in [hand]; burrhole docs scene lists its keys");
  CHECK_FALSE(when_read("hand", "nonsense").has_value());
  CHECK_FALSE(when_read("tool", "spin_rpm").has_value());  // always read
}
