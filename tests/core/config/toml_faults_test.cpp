#include <doctest/doctest.h>

#include <functional>

#include "core/config/toml.h"

using namespace burrhole;

namespace {

struct Fault {
  const char* text;                        ///< the file
  std::function<void(TableReader&)> read;  ///< what a schema asks for
  std::vector<std::string> lines;          ///< issues expected, as printed
};

std::vector<std::string> printed(const Fault& fault) {
  const auto document = TomlDocument::parse(fault.text, "skull.toml");
  if (!document) return {document.error().text()};
  Issues issues;
  TableReader root = document.value().root(issues);
  fault.read(root);
  std::vector<std::string> lines;
  for (const Error& issue : issues) lines.push_back(issue.text());
  return lines;
}

const auto kRadius = [](TableReader& root) {
  auto tool = root.table("tool", "the bit");
  if (tool) {
    const double r = tool->number("radius_mm", {.min = 0.0, .max = 20.0, .min_open = true, .to_si = 1e-3}, "radius of the head");
    CHECK((r > 0.0 && r <= 0.02));  // whatever the file says, reading goes on with a value inside the rule
    tool->finish();
  }
  root.finish();
};
const auto kVolume = [](TableReader& root) {
  if (auto volume = root.table("volume", "v")) {
    volume->number("spacing_mm", {.fallback = 1.0}, "edge of a voxel");
    volume->text("source", "phantom", "where from");
    volume->number("peak_force_N", {.fallback = 1.0}, "force");
    volume->number("stiffness_n_per_m", {.fallback = 1.0}, "stiffness");
    volume->finish();
  }
  root.table("contact", "c");
  root.tables("region", "r");
  root.finish();
};
const auto kModel = [](TableReader& root) {
  CHECK(root.choice("model", "mcneely", {"mcneely", "petersik"}, "contact model", {"acosta"}) == "mcneely");
};
const auto kMisc = [](TableReader& root) {
  root.integer("count", 1, 1, 9, "n");
  root.boolean("on", false, "b");
  root.text("title", "", "t");
  root.vector("size_mm", Vec3(1.0), {.min = 0.0}, "v");
  root.finish();
};

}  // namespace

TEST_CASE("errors: each kind is one line with its place") {
  const std::vector<Fault> faults = {
      // numbers
      {"\n[tool]\n  radius_mm = -5\n", kRadius, {"skull.toml:3:3: tool.radius_mm = -5 must be in (0, 20]"}},
      {"[tool]\nradius_mm = 20.5", kRadius, {"skull.toml:2:1: tool.radius_mm = 20.5 must be in (0, 20]"}},
      {"[tool]\nradius_mm = 0", kRadius, {"skull.toml:2:1: tool.radius_mm = 0 must be in (0, 20]"}},
      {"[tool]\nradius_mm = nan", kRadius, {"skull.toml:2:1: tool.radius_mm = nan must be a finite number"}},
      {"[tool]\nradius_mm = -inf", kRadius, {"skull.toml:2:1: tool.radius_mm = -inf must be a finite number"}},
      {"[tool]\nradius_mm = \"5\"", kRadius, {"skull.toml:2:1: tool.radius_mm = \"5\" must be a number"}},
      {"[tool]\nradius_mm = [1]", kRadius, {"skull.toml:2:1: tool.radius_mm = [1] must be a number"}},
      {"[tool]\nradius_mm = 2020-01-01", kRadius, {"skull.toml:2:1: tool.radius_mm = a date or time must be a number"}},
      {"[tool]\n", kRadius, {"skull.toml:1:2: tool.radius_mm is missing (radius of the head)"}},
      // units
      {"[tool]\nradius = 5", kRadius, {"skull.toml:2:1: tool.radius lacks its unit: write \"radius_mm\""}},
      {"[volume]\nspacing = 5", kVolume, {"skull.toml:2:1: volume.spacing lacks its unit: write \"spacing_mm\""}},
      {"[volume]\npeak_force = 5", kVolume, {"skull.toml:2:1: volume.peak_force lacks its unit: write \"peak_force_N\""}},
      {"[volume]\nstiffness = 5", kVolume, {"skull.toml:2:1: volume.stiffness lacks its unit: write \"stiffness_n_per_m\""}},
      {"[volume]\nspacing_cm = 5", kVolume, {"skull.toml:2:1: unknown key \"spacing_cm\" in [volume]; did you mean \"spacing_mm\"?"}},
      // names
      {"[volume]\n spacng_mm = 5", kVolume, {"skull.toml:2:2: unknown key \"spacng_mm\" in [volume]; did you mean \"spacing_mm\"?"}},
      {"[volume]\ncolour = 5", kVolume, {"skull.toml:2:1: unknown key \"colour\" in [volume]"}},
      {"volum = 5", kVolume, {"skull.toml:1:1: unknown key \"volum\"; did you mean \"volume\"?"}},
      {"[contcat]\nx = 1", kVolume, {"skull.toml:1:2: unknown table [contcat]; did you mean [contact]?"}},
      {"[volume.sub]\nx = 1", kVolume, {"skull.toml:1:9: unknown table [volume.sub]"}},
      {"[[regoin]]\nx = 1", kVolume, {"skull.toml:1:3: unknown table [regoin]; did you mean [region]?"}},
      {"[volume]\n\"a\\nb\" = 5", kVolume, {"skull.toml:2:1: unknown key \"a\\nb\" in [volume]"}},
      {"a = 1\n[volume]\nsorce = 5\nspace_mm = 2\n",
       kVolume,
       {"skull.toml:3:1: unknown key \"sorce\" in [volume]; did you mean \"source\"?",
        "skull.toml:4:1: unknown key \"space_mm\" in [volume]; did you mean \"spacing_mm\"?", "skull.toml:1:1: unknown key \"a\""}},
      // shapes of tables
      {"contact = 5", kVolume, {"skull.toml:1:1: contact = 5 must be a table: [contact]"}},
      {"[region]", kVolume, {"skull.toml:1:2: region = {table} must be an array of tables: [[region]]"}},
      {"region = [1, 2]", kVolume, {"skull.toml:1:1: region = [1, 2] must be an array of tables: [[region]]"}},
      // choices
      {"model = \"petrsik\"",
       kModel,
       {"skull.toml:1:1: model = \"petrsik\" must be one of \"mcneely\", \"petersik\"; did you mean \"petersik\"?"}},
      {"model = \"x\"", kModel, {"skull.toml:1:1: model = \"x\" must be one of \"mcneely\", \"petersik\""}},
      {"model = \"acosta\"", kModel, {"skull.toml:1:1: model = \"acosta\" is not in this version; it knows \"mcneely\", \"petersik\""}},
      {"model = 3", kModel, {"skull.toml:1:1: model = 3 must be one of \"mcneely\", \"petersik\""}},
      // the other types
      {"count = 1.5", kMisc, {"skull.toml:1:1: count = 1.5 must be a whole number"}},
      {"count = 0", kMisc, {"skull.toml:1:1: count = 0 must be a whole number in [1, 9]"}},
      {"on = 1", kMisc, {"skull.toml:1:1: on = 1 must be true or false"}},
      {"title = true", kMisc, {"skull.toml:1:1: title = true must be text in quotes"}},
      {"size_mm = [1, 2]", kMisc, {"skull.toml:1:1: size_mm = [1, 2] must be an array of 3 numbers"}},
      {"size_mm = 1", kMisc, {"skull.toml:1:1: size_mm = 1 must be an array of 3 numbers"}},
      {"size_mm = [1,\n  nan, -3]",
       kMisc,
       {"skull.toml:2:3: size_mm[1] = nan must be a finite number", "skull.toml:2:8: size_mm[2] = -3 must be at least 0"}},
  };
  for (const Fault& fault : faults) {
    CAPTURE(fault.text);
    CHECK(printed(fault) == fault.lines);
  }
}

TEST_CASE("errors: syntax errors are one line with line and column") {
  for (const char* text :
       {"x = \ny = 2", "x = 1\nx = 2", "[a]\n[a]", "x = 1e", "x = \"abc", "\xff\xfe", "x = 99999999999999999999", "[a\n", "= 1"}) {
    CAPTURE(text);
    const auto document = TomlDocument::parse(text, "skull.toml");
    REQUIRE_FALSE(document.ok());
    CHECK(document.error().place.rfind("skull.toml:", 0) == 0);
    CHECK_FALSE(document.error().message.empty());
    CHECK(document.error().text().find_first_of("\r\n") == std::string::npos);
  }
  const auto second = TomlDocument::parse("a = 1\n  b = ?\n", "skull.toml");
  REQUIRE_FALSE(second.ok());
  CHECK(second.error().place == "skull.toml:2:7");
}

TEST_CASE("errors: a check of the caller's own lands at the key with its value") {
  const auto document = TomlDocument::parse("[a]\nlow = 3\nhigh = 2\n", "skull.toml");
  REQUIRE(document.ok());
  Issues issues;
  TableReader root = document.value().root(issues);
  root.table("a", "a")->fault("high", "must be above low");
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].text() == "skull.toml:3:1: a.high = 2 must be above low");
}

TEST_CASE("errors: a key asked for only by has() is known, one never asked for is not") {
  const auto document = TomlDocument::parse("a = 1\nb = 2\n", "skull.toml");
  REQUIRE(document.ok());
  Issues issues;
  TableReader root = document.value().root(issues);
  CHECK(root.has("a"));
  CHECK_FALSE(root.has("c"));
  root.finish();
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].text() == "skull.toml:2:1: unknown key \"b\"");
}

TEST_CASE("nearest_name: slips of the keyboard are found, other words are not") {
  const std::vector<std::string> names = {"spacing_mm", "source", "spin_rpm", "tool"};
  CHECK(nearest_name("spacng_mm", names) == "spacing_mm");  // a letter missing
  CHECK(nearest_name("souurce", names) == "source");        // one too many
  CHECK(nearest_name("spin_rmp", names) == "spin_rpm");     // two swapped
  CHECK(nearest_name("tolo", names) == "tool");             // two swapped are one slip, and a short word may have one
  CHECK(nearest_name("Tool", names) == "tool");             // capitals
  CHECK(nearest_name("perforator", {"perforator_14_11", "acosta_liu_perforator"}) == "perforator_14_11");  // typed in part
  CHECK_FALSE(nearest_name("round_burr", {"round_burr_2mm", "round_burr_4mm"}).has_value());               // of two
  CHECK_FALSE(nearest_name("heat", names).has_value());
  CHECK_FALSE(nearest_name("x", names).has_value());
  CHECK_FALSE(nearest_name("", names).has_value());
  CHECK_FALSE(nearest_name("tool", {}).has_value());
  CHECK(nearest_name("aab", {"aaa", "aac"}) == "aaa");  // equally near: the first
}
