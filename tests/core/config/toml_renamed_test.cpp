// Texts of earlier versions are brought to today's keys, and an unknown key is reported with the name that it has now.
#include <doctest/doctest.h>

#include "core/config/toml.h"

namespace burrhole {
namespace {

constexpr RenamedWord kWords[] = {{"penalty", "voxmap"}};
constexpr RenamedKey kTable[] = {{"tool.spin", "tool.spin_rpm", 60.0},
                                 {"servo.rate_hz", "servo_hz"},
                                 {"contact.kind", "contact.model", 1.0, kWords},
                                 {"servo.gone", ""},
                                 {"region[].size", "region[].size_mm", 1000.0},
                                 {"region[].old", ""},
                                 {"looks", "display.looks"}};

TomlDocument parsed(const char* text) {
  auto document = TomlDocument::parse(text, "old.toml");
  REQUIRE_MESSAGE(document.ok(), (document ? "" : document.error().text()));
  return *document;
}

TEST_CASE("renamed keys: moved, converted and listed; what is not in the table stays") {
  TomlDocument document = parsed(
      "title = 'x'\n[tool]\nspin = 2\nname = 'penalty'\n[servo]\nrate_hz = 1000\ngone = 1\n[contact]\nkind = 'penalty'\n"
      "[[region]]\nsize = [1, 0.5]\nold = 3\n[[region]]\nsize = [2, 2]\n[looks]\ncolour = 'red'\n");
  const std::vector<Renaming> expected = {{"tool.spin", "tool.spin_rpm"},
                                          {"servo.rate_hz", "servo_hz"},
                                          {"contact.kind", "contact.model"},
                                          {"servo.gone", ""},
                                          {"region[].size", "region[].size_mm"},
                                          {"region[].size", "region[].size_mm"},
                                          {"region[].old", ""},
                                          {"looks", "display.looks"}};
  CHECK(document.rename(kTable) == expected);
  const TomlDocument now = parsed(
      "title = 'x'\nservo_hz = 1000\n[tool]\nspin_rpm = 120.0\nname = 'penalty'\n[servo]\n[contact]\nmodel = 'voxmap'\n"
      "[[region]]\nsize_mm = [1000.0, 500.0]\n[[region]]\nsize_mm = [2000.0, 2000.0]\n[display.looks]\ncolour = 'red'\n");
  CHECK(document.to_text() == now.to_text());
  // Once more there is nothing to do.
  CHECK(document.rename(kTable).empty());
}

TEST_CASE("renamed keys: today's key stays where a text has both, and the list says so") {
  TomlDocument document = parsed("[tool]\nspin = 2\nspin_rpm = 7\n");
  CHECK(document.rename(kTable) == std::vector<Renaming>{{"tool.spin", "tool.spin_rpm", true}});
  CHECK(document.to_text() == parsed("[tool]\nspin_rpm = 7\n").to_text());
}

TEST_CASE("renamed keys: assignments before and after a renaming, and where a value came from") {
  TomlDocument document = parsed("[tool]\nspin = 2\n[servo]\nrate_hz = 'fast'\n");
  REQUIRE(document.set("tool.spin=3"));
  document.rename(kTable);
  REQUIRE(document.set("contact.model=voxmap"));
  CHECK(document.to_text() == parsed("servo_hz = 'fast'\n[tool]\nspin_rpm = 180.0\n[servo]\n[contact]\nmodel = 'voxmap'\n").to_text());
  Issues issues;
  document.root(issues).integer("servo_hz", 1000, 1, 20000, "ticks a second");
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].place == "old.toml:4:1");  // the line of the old key
}

TEST_CASE("renamed keys: a table of another shape in the text is left alone") {
  TomlDocument document = parsed("tool = 3\nregion = {size = 1}\nlooks = 1\ndisplay = 2\n");
  CHECK(document.rename(kTable) == std::vector<Renaming>{{"looks", "display.looks", true}});
  CHECK(document.to_text() == parsed("tool = 3\nregion = {size = 1}\ndisplay = 2\n").to_text());
}

TEST_CASE("renamed keys: an unknown key is reported with its new name") {
  TomlDocument document = parsed("[tool]\nspin = 2\nspim_rpm = 3\n[servo]\ngone = 1\n[[region]]\nsize = [1]\n[looks]\na = 1\n");
  document.report_renamed(kTable);
  Issues issues;
  TableReader root = document.root(issues);
  TableReader tool = *root.table("tool", "");
  tool.number("spin_rpm", {.fallback = 1.0}, "");
  TableReader servo = *root.table("servo", "");
  std::vector<TableReader> regions = root.tables("region", "");
  REQUIRE(regions.size() == 1);
  for (TableReader* reader : {&tool, &servo, &regions[0], &root}) reader->finish();
  std::vector<std::string> texts;
  for (const Error& issue : issues) texts.push_back(issue.text());
  CHECK(texts == std::vector<std::string>{"old.toml:2:1: tool.spin is now tool.spin_rpm, 60 times the value",
                                          "old.toml:3:1: unknown key \"spim_rpm\" in [tool]; did you mean \"spin_rpm\"?",
                                          "old.toml:5:1: servo.gone is no longer read: remove it",
                                          "old.toml:7:1: region[0].size is now region[].size_mm, 1000 times the value",
                                          "old.toml:8:2: looks is now display.looks"});
}

}  // namespace
}  // namespace burrhole
