#include "core/config/toml.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

using namespace burrhole;

namespace {

TomlDocument parsed(std::string_view text) {
  auto document = TomlDocument::parse(text, "skull.toml");
  REQUIRE_MESSAGE(document.ok(), (document.ok() ? "" : document.error().text()));
  return std::move(document).value();
}

}  // namespace

TEST_CASE("reader: values arrive in SI and every rule's fallback too") {
  const TomlDocument document = parsed("radius_mm = 2.5\ncount = 3\non = true\nname = \"a\"\nsize_mm = [1, 2.0, 3]\nkind = \"x\"\n");
  Issues issues;
  TableReader root = document.root(issues);
  CHECK(root.number("radius_mm", {.min = 0.0, .to_si = 1e-3}, "r") == 2.5 * 1e-3);
  CHECK(root.number("other_mm", {.fallback = 4.0, .to_si = 1e-3}, "r") == 4.0 * 1e-3);
  CHECK(root.integer("count", 1, 0, 10, "n") == 3);
  CHECK(root.integer("none", 7, 0, 10, "n") == 7);
  CHECK(root.boolean("on", false, "b"));
  CHECK(root.boolean("off", true, "b"));
  CHECK(root.text("name", std::nullopt, "t") == "a");
  CHECK(root.text("label", "none", "t") == "none");
  CHECK(root.choice("kind", std::nullopt, {"x", "y"}, "k") == "x");
  CHECK(root.choice("sort", "y", {"x", "y"}, "k") == "y");
  CHECK(root.vector("size_mm", std::nullopt, {.to_si = 1e-3}, "v") == Vec3(1.0 * 1e-3, 2.0 * 1e-3, 3.0 * 1e-3));
  CHECK(root.vector("shift_mm", Vec3(1.0, 0.0, 0.0), {.to_si = 1e-3}, "v") == Vec3(1e-3, 0.0, 0.0));
  root.finish();
  CHECK(issues.empty());
}

TEST_CASE("reader: keys come in the order of the file, not of the alphabet") {
  const TomlDocument document = parsed("zebra = 1\napple = 2\n[volume]\nb = 1\na = 2\n[approach]\n");
  Issues issues;
  CHECK(document.root(issues).keys() == std::vector<std::string>{"zebra", "apple", "volume", "approach"});
  CHECK(document.root(issues).table("volume", "v")->keys() == std::vector<std::string>{"b", "a"});
}

TEST_CASE("reader: tables and arrays of tables know their names and places") {
  const TomlDocument document = parsed("[tool]\nx = 1\n\n[[region]]\na = 1\n  [[region]]\na = 2\n");
  Issues issues;
  TableReader root = document.root(issues);
  CHECK(root.name().empty());
  CHECK(root.place() == "skull.toml");
  const auto tool = root.table("tool", "t");
  REQUIRE(tool);
  CHECK(tool->name() == "tool");
  CHECK(tool->place() == "skull.toml:1:2");
  CHECK(tool->place_of("x") == "skull.toml:2:1");
  CHECK(tool->place_of("absent") == "skull.toml:1:2");
  const auto regions = root.tables("region", "r");
  REQUIRE(regions.size() == 2);
  CHECK(regions[1].name() == "region[1]");
  CHECK(regions[1].place() == "skull.toml:6:3");
  CHECK_FALSE(root.table("heat", "h"));
  CHECK(root.tables("lamp", "l").empty());
  CHECK(issues.empty());
}

TEST_CASE("reader: asking twice for a table gives the same reader, so a key is reported once") {
  const TomlDocument document = parsed("[tool]\nx = 1\ny = 2\n");
  Issues issues;
  TableReader root = document.root(issues);
  CHECK(root.table("tool", "t")->number("x", {}, "x") == 1.0);
  auto again = root.table("tool", "t");
  again->finish();
  again->finish();
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].message == "unknown key \"y\" in [tool]");
}

TEST_CASE("reader: it keeps its document alive") {
  Issues issues;
  std::optional<TableReader> root;
  {
    const TomlDocument document = parsed("x = 5\n");
    root = document.root(issues);
  }
  CHECK(root->number("x", {}, "x") == 5.0);
}

TEST_CASE("document: to_text parses back to the same values, to the last bit") {
  const TomlDocument document =
      parsed("x = 0.30000000000000004\nn = -7\nwhole = 5.0\n[[region]]\nname = \"a \\\"b\\\"\"\nv_mm = [1e-300, 2]\n");
  const std::string text = document.to_text();
  const TomlDocument again = parsed(text);
  CHECK(again.to_text() == text);
  Issues issues;
  TableReader root = again.root(issues);
  CHECK(root.number("x", {}, "x") == 0.30000000000000004);
  CHECK(root.integer("n", std::nullopt, -10, 10, "n") == -7);
  CHECK(root.number("whole", {}, "w") == 5.0);
  TableReader region = root.tables("region", "r").at(0);
  CHECK(region.text("name", std::nullopt, "n") == "a \"b\"");
  CHECK(region.numbers("v_mm", std::nullopt, 2, {}, "v") == std::vector<double>{1e-300, 2.0});
  CHECK(issues.empty());
}

TEST_CASE("document: load reads a file and a missing one says why") {
  const auto folder = std::filesystem::temp_directory_path() / "burrhole_toml_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "a.toml").string();
  std::ofstream(path) << "x = 1\n";
  const auto loaded = TomlDocument::load(path);
  REQUIRE(loaded.ok());
  CHECK(loaded.value().file_name() == path);
  const auto missing = TomlDocument::load((folder / "b.toml").string());
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().code == ErrorCode::bad_input);
  CHECK(missing.error().text() == (folder / "b.toml").string() + ": cannot be read: No such file or directory");
  const auto directory = TomlDocument::load(folder.string());
  REQUIRE_FALSE(directory.ok());
  CHECK(directory.error().text() == folder.string() + ": is a folder: give a file");
  std::filesystem::remove_all(folder);
}
