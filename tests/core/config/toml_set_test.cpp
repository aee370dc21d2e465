#include <doctest/doctest.h>

#include "core/config/toml.h"

using namespace burrhole;

namespace {

TomlDocument parsed(std::string_view text) {
  auto document = TomlDocument::parse(text, "skull.toml");
  REQUIRE(document.ok());
  return std::move(document).value();
}

}  // namespace

TEST_CASE("set: values in TOML syntax, bare words and paths as text, tables made as needed") {
  TomlDocument document = parsed("[tool]\nspin_rpm = 800\n[[region]]\ne = 1\n[[region]]\ne = 2\n");
  for (const char* assignment :
       {"tool.spin_rpm=1000", "tool.name = perforator_14_11", "volume.source=phantom:skull_patch", "display.size=[800, 600]",
        "record.path=/tmp/a b/c-1.session", "record.note=\"1, 2\"", "tool.on=false", "region[1].e=0.5", "contact={rate_hz=500}"})
    REQUIRE_MESSAGE(document.set(assignment).ok(), assignment);
  Issues issues;
  TableReader root = document.root(issues);
  auto tool = root.table("tool", "t");
  REQUIRE(tool);
  CHECK(tool->number("spin_rpm", {}, "s") == 1000.0);
  CHECK(tool->text("name", std::nullopt, "n") == "perforator_14_11");
  CHECK_FALSE(tool->boolean("on", true, "o"));
  CHECK(root.table("volume", "v")->text("source", std::nullopt, "s") == "phantom:skull_patch");
  CHECK(root.table("display", "d")->numbers("size", std::nullopt, 2, {}, "s") == std::vector<double>{800.0, 600.0});
  CHECK(root.table("record", "r")->text("path", std::nullopt, "p") == "/tmp/a b/c-1.session");
  CHECK(root.table("record", "r")->text("note", std::nullopt, "p") == "1, 2");
  CHECK(root.tables("region", "r").at(0).number("e", {}, "e") == 1.0);
  CHECK(root.tables("region", "r").at(1).number("e", {}, "e") == 0.5);
  CHECK(root.table("contact", "c")->number("rate_hz", {}, "r") == 500.0);
  CHECK(issues.empty());
}

TEST_CASE("set: later places name the assignment, others keep their line") {
  TomlDocument document = parsed("[tool]\nspin_rpm = 800\nradius_mm = 2\n");
  REQUIRE(document.set("tool.spin_rpm=-1").ok());
  REQUIRE(document.set("heat.step_ms=0").ok());
  Issues issues;
  TableReader root = document.root(issues);
  auto tool = root.table("tool", "t");
  tool->number("spin_rpm", {.min = 0.0}, "s");
  tool->number("radius_mm", {.min = 5.0}, "r");
  auto heat = root.table("heat", "h");
  REQUIRE(heat);
  heat->number("step_ms", {.min = 0.0, .min_open = true}, "s");
  heat->number("depth_mm", {}, "d");
  REQUIRE(issues.size() == 4);
  CHECK(issues[0].text() == "--set tool.spin_rpm: tool.spin_rpm = -1 must be at least 0");
  CHECK(issues[1].text() == "skull.toml:3:1: tool.radius_mm = 2 must be at least 5");
  CHECK(issues[2].text() == "--set heat.step_ms: heat.step_ms = 0 must be > 0");
  CHECK(issues[3].text() == "--set heat.step_ms: heat.depth_mm is missing (d)");
}

TEST_CASE("set: an element of an array of tables by its name, a blank as _ or -") {
  TomlDocument document = parsed("[[region]]\nname = \"inner drill\"\ne = 1\n[[region]]\nname = \"shank\"\ne = 2\n");
  REQUIRE(document.set("region.inner_drill.e=0.25", "--set-tool").ok());
  REQUIRE(document.set("region.inner-drill.f=-1", "--set-tool").ok());
  REQUIRE(document.set("region.shank.e=0.5", "--set-tool").ok());
  CHECK(document.changes() == std::vector<std::string>{"region.inner_drill.e=0.25", "region.inner-drill.f=-1", "region.shank.e=0.5"});
  const Status wrong = document.set("region.shaft.e=1", "--set-tool");
  REQUIRE_FALSE(wrong.ok());
  CHECK(wrong.error().text() == "--set-tool region.shaft.e=1: region has no \"shaft\"; it has \"inner_drill\", \"shank\"");
  Issues issues;
  TableReader root = document.root(issues);
  std::vector<TableReader> regions = root.tables("region", "r");
  CHECK(regions.at(0).number("e", {}, "e") == 0.25);
  CHECK(regions.at(1).number("e", {}, "e") == 0.5);
  regions.at(0).number("f", {.min = 0.0}, "f");
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().text() == "--set-tool region[0].f: region[0].f = -1 must be at least 0");
}

TEST_CASE("set: a name with a blank is accepted in quotes, and without them the error says what to write") {
  TomlDocument document = parsed("[[region]]\nname = \"inner drill\"\ne = 1\n[[region]]\nname = \"shank\"\ne = 2\n");
  REQUIRE(document.set("region.\"inner drill\".e=0.25").ok());
  REQUIRE(document.set("region.'shank'.e=0.5").ok());
  CHECK(document.set("region.inner drill.e=1").error().message == "a blank in a name is written as _: write region.inner_drill.e");
  CHECK(document.set("region.inner dril.e=1").error().message == "region has no \"inner_dril\"; it has \"inner_drill\", \"shank\"");
  for (const char* assignment : {"region.\"inner drill.e=1", "region.\"\".e=1", "tool.spin rpm=1", "inner drill=1"})
    CHECK(document.set(assignment).error().message == "the part before '=' must read table.key");
  Issues issues;
  std::vector<TableReader> regions = document.root(issues).tables("region", "r");
  CHECK(regions.at(0).number("e", {}, "e") == 0.25);
  CHECK(regions.at(1).number("e", {}, "e") == 0.5);
}

TEST_CASE("set: a number with its unit is refused with what to write") {
  TomlDocument document = parsed("[tool]\n");
  const std::pair<const char*, const char*> table[] = {
      {"duration_s=30s", "write 30; the unit is in the key's name"},
      {"tool.spin_rpm=1000 RPM", "write 1000; the unit is in the key's name"},
      {"hand.feed_mm_per_s=0.5 mm/s", "write 0.5; the unit is in the key's name"},
      {"tool.shade_percent=28%", "write 28; the unit is in the key's name"},
      {"contact.share=28%", "write 0.28: a share is a number, and 1 is all"},
      {"duration_s=5 min", "write a number alone: the unit is that of the key's name, s"},
      {"tool.spin=1000rpm", "the unit is in the key's name: write tool.spin_rpm=1000"},
      {"tool.title=3dprinted", "the part after '=' is not a TOML value; put text in quotes"},
      {"tool.title=1 2", "the part after '=' is not a TOML value; put text in quotes"},
  };
  for (const auto& [assignment, message] : table) {
    CAPTURE(assignment);
    CHECK(document.set(assignment).error().message == message);
  }
  REQUIRE(document.set("tool.spin_rpm=\"800 rpm\"").ok());
  REQUIRE(document.set("tool.size_mm=[1, \"2 mm\"]").ok());
  Issues issues;
  TableReader root = document.root(issues);
  static_cast<void>(root.table("tool", "t")->number("spin_rpm", {.fallback = 1.0}, "s"));
  static_cast<void>(root.table("tool", "t")->numbers("size_mm", std::nullopt, 2, {}, "s"));
  REQUIRE(issues.size() == 2);
  CHECK(issues.back().message == "tool.size_mm[1] = \"2 mm\" must be a number: write 2; the unit is in the key's name");
  CHECK(issues.front().message == "tool.spin_rpm = \"800 rpm\" must be a number: write 800; the unit is in the key's name");
}

TEST_CASE("unset: tables and keys go, what is not there is an error with the nearest name") {
  TomlDocument document = parsed("[tool]\nspin_rpm = 800\nname = \"a\"\n[display]\n[record]\n");
  REQUIRE(document.unset("display").ok());
  REQUIRE(document.unset("tool.spin_rpm").ok());
  REQUIRE(document.set("tool.name=b").ok());  // applies the removals again
  CHECK(document.to_text().find("display") == std::string::npos);
  CHECK(document.to_text().find("spin_rpm") == std::string::npos);
  CHECK(document.changes() == std::vector<std::string>{"unset display", "unset tool.spin_rpm", "tool.name=b"});
  for (const auto& [path, message] :
       {std::pair("recrod", "the file has no \"recrod\"; did you mean \"record\"?"),
        std::pair("tool.nmae", "the file has no \"tool.nmae\"; did you mean \"name\"?"), std::pair("tol.name", "the file has no \"tol\""),
        std::pair("tool.", "must read table or table.key")}) {
    const Status wrong = document.unset(path);
    REQUIRE_FALSE(wrong.ok());
    CHECK(wrong.error().message == message);
  }
}

TEST_CASE("set: a key without its table is named with it") {
  TomlDocument document = parsed("spin_rpm = 800\npush = 3\n[tool]\n[hand]\n");
  Issues issues;
  TableReader root = document.root(issues);
  auto tool = root.table("tool", "t"), hand = root.table("hand", "h");
  tool->number("spin_rpm", {.fallback = 1.0}, "s");
  hand->number("push_N", {.fallback = 1.0}, "p");
  root.finish();
  REQUIRE(issues.size() == 2);
  CHECK(issues[0].message == "unknown key \"spin_rpm\"; did you mean \"tool.spin_rpm\"?");
  CHECK(issues[1].message == "unknown key \"push\"; did you mean \"hand.push_N\"?");
}

TEST_CASE("set: bad assignments are refused and leave the document as it was") {
  TomlDocument document = parsed("x = 1\nregion = [{e = 1}]\n");
  const std::string before = document.to_text();
  const std::pair<const char*, const char*> table[] = {
      {"x", "--set x: must read table.key=value"},
      {"=5", "--set =5: the part before '=' must read table.key"},
      {"a..b=5", "--set a..b=5: the part before '=' must read table.key"},
      {"a b=5", "--set a b=5: the part before '=' must read table.key"},
      {"region[0]=5", "--set region[0]=5: the part before '=' must read table.key"},
      {"region[9].e=5", "--set region[9].e=5: \"region[9]\" is not a table"},
      {"none[0].e=5", "--set none[0].e=5: \"none\" is not a table"},
      {"x.y=5", "--set x.y=5: \"x\" is not a table"},
      {"a.b=", "--set a.b=: the part after '=' is not a TOML value; put text in quotes"},
      {"a.b=5mm", "--set a.b=5mm: the unit is in the key's name: write a.b_mm=5"},
      {"a.b=[1,", "--set a.b=[1,: the part after '=' is not a TOML value; put text in quotes"},
      {"a.b=one, two", "--set a.b=one, two: the part after '=' is not a TOML value; put text in quotes"},
      {"a.b=2,8", "--set a.b=2,8: is no number: write a point for decimals, or [2,8] for an array"},
      {"a.b = 28, c.d = 800",
       "--set a.b = 28, c.d = 800: holds a second assignment: give each its own --set, as in --set a.b=28 --set c.d = 800"},
      {"a.b=1\nc=2", "--set a.b=1\\nc=2: the part after '=' is not a TOML value; put text in quotes"},
  };
  for (const auto& [assignment, line] : table) {
    const Status status = document.set(assignment);
    CAPTURE(assignment);
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().text() == line);
  }
  CHECK(document.to_text() == before);
}

TEST_CASE("apply: a thousand changes parse the text once, as one does, and give the same document as one after another") {
  auto document = *TomlDocument::parse("[tool]\nname = \"ball\"\n[record]\n", "scene.toml");
  TomlDocument one_by_one = document;
  CHECK(document.parses() == 1);
  std::vector<TomlChange> changes{{"record", "--unset", true}};
  for (int n = 0; n < 999; ++n) changes.push_back({"tool.spin_rpm=" + std::to_string(n)});
  CHECK(document.apply(changes).empty());
  CHECK(document.parses() == 2);
  for (const TomlChange& change : changes)
    REQUIRE((change.removes ? one_by_one.unset(change.text, change.option) : one_by_one.set(change.text, change.option)).ok());
  CHECK(one_by_one.parses() == 1001);
  CHECK(document.to_text() == one_by_one.to_text());
  CHECK(document.changes() == one_by_one.changes());
  Issues issues;
  CHECK(document.root(issues).table("tool", "")->place_of("spin_rpm") == "--set tool.spin_rpm");
}

TEST_CASE("apply: every error is reported, and after one the document is as it was") {
  auto document = *TomlDocument::parse("[tool]\nname = \"ball\"\n", "scene.toml");
  const std::string before = document.to_text();
  const Issues issues = document.apply({{"tool.name=\"cone\""}, {"tool.name"}, {"hand", "--unset", true}});
  REQUIRE(issues.size() == 2);
  CHECK(issues[0].place == "--set tool.name");
  CHECK(issues[1].place == "--unset hand");
  CHECK(document.to_text() == before);
  CHECK(document.changes().empty());
}

TEST_CASE("set: a copy of the document and readers made before are not touched") {
  TomlDocument document = parsed("x = 1\n");
  const TomlDocument copy = document;
  Issues issues;
  TableReader early = document.root(issues);
  REQUIRE(document.set("x=2").ok());
  CHECK(early.number("x", {}, "x") == 1.0);
  CHECK(copy.root(issues).number("x", {}, "x") == 1.0);
  CHECK(document.root(issues).number("x", {}, "x") == 2.0);
}
