#include <doctest/doctest.h>

#include "core/config/toml.h"
#include "core/config/toml_shape.h"

using namespace burrhole;

namespace {

/// @returns the error of a text as printed; empty: it has an allowed shape.
std::string refusal(const std::string& text) {
  const Status shape = check_toml_shape(text, "f.toml");
  return shape ? std::string() : shape.error().text();
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string out;
  for (std::size_t n = 0; n < count; ++n) out += text;
  return out;
}

/// A key of `parts` parts.
std::string dotted(std::size_t parts) { return "a" + repeated(".a", parts - 1); }

}  // namespace

TEST_CASE("toml shape: a key of more parts than the limit is refused at the part, wherever a key may stand") {
  struct Where {
    std::string before, after;
  };
  for (const Where& where : {Where{"", "\n"},
                             {"\n\n ", "\n"},
                             {"x = 1 # a.b\n", "\n"},
                             {"[t]\n", "\n"},
                             {"[[t]]\n", "\n"},
                             {"s = \"\"\"\n[\n\"\"\"\n", "\n"},
                             {"i = { ", " }\n"},
                             {"i = [ { x = 1, ", " } ]\n"}}) {
    CAPTURE(where.before);
    const auto text = [&](std::size_t parts) { return where.before + dotted(parts) + " = 1" + where.after; };
    CHECK(refusal(text(kMostKeyParts)) == "");
    CHECK(TomlDocument::parse(text(kMostKeyParts), "f.toml").ok());
    CHECK(refusal(text(kMostKeyParts + 1)).find(": a key has more than 16 parts") != std::string::npos);
    CHECK_FALSE(TomlDocument::parse(text(kMostKeyParts + 1), "f.toml").ok());
    CHECK_FALSE(TomlDocument::parse(text(50'000), "f.toml").ok());
  }
  CHECK(refusal("[" + dotted(17) + "]\n") == "f.toml:1:33: a key has more than 16 parts");
  CHECK(refusal("x = 1\n[[ " + dotted(50'000) + " ]]\n") == "f.toml:2:35: a key has more than 16 parts");
  CHECK(refusal(repeated("'a' . ", 16) + "b = 1") == "f.toml:1:95: a key has more than 16 parts");
}

TEST_CASE("toml shape: brackets deeper than the limit are refused, brackets in strings and comments do not count") {
  CHECK(refusal("a = " + repeated("[", kMostNested) + repeated("]", kMostNested)) == "");
  CHECK(refusal("a = " + repeated("[", kMostNested + 1)) == "f.toml:1:37: arrays and inline tables are nested deeper than 32 levels");
  CHECK(refusal("a = " + repeated("{a=", 50'000)).find("nested deeper") != std::string::npos);
  CHECK(refusal("a = " + repeated("[{a=", 50'000)).find("nested deeper") != std::string::npos);
  for (const std::string quiet :
       {R"("%")", R"('%')", "\"\"\"%\n%\"\"\"", "'''%\n%'''", "1 # %", R"("\"%\\")", R"("""%""%\""""")", "[] # %"}) {
    std::string text = "a = " + quiet + "\nb = 1\n";
    for (std::size_t at = 0; (at = text.find('%')) != std::string::npos;) text.replace(at, 1, repeated("[", 100));
    CHECK_MESSAGE(refusal(text) == "", quiet);
    CHECK_MESSAGE(TomlDocument::parse(text, "f.toml").ok(), quiet);
  }
  CHECK(refusal("b = 1\n" + repeated("[[t]]\na = [[], {}]\n", 100)) == "");
}

TEST_CASE("toml shape: long keys, many tables, many bytes and a byte 0 are refused with their place") {
  CHECK(refusal(std::string(kLongestKey, 'k') + " = 1") == "");
  CHECK(refusal("\n" + std::string(kLongestKey + 1, 'k') + " = 1") == "f.toml:2:257: a key is longer than 256 bytes");
  CHECK(refusal("\"" + std::string(5000, 'k') + "\" = 1").find("a key is longer") != std::string::npos);
  CHECK(refusal("a = \"" + std::string(5000, 'v') + "\"") == "");
  CHECK(refusal(repeated("[[r]]\n", kMostTables)) == "");
  CHECK(refusal(repeated("[[r]]\n", kMostTables + 1)) == "f.toml:10001:1: has more than 10000 tables");
  CHECK(refusal(std::string(kMostTomlBytes + 1, '#')) == "f.toml: has more than 4194304 bytes of TOML");
  CHECK(refusal(std::string("a = 1\nb = \"x\0\"", 14)).find("f.toml:2:7: holds a byte 0") == 0);
}

TEST_CASE("set: assignments of too many parts, too long keys, too deep values and too many changes are refused") {
  auto document = TomlDocument::parse("[tool]\nspin_rpm = 1\n", "f.toml");
  REQUIRE(document.ok());
  const auto refused = [&](const std::string& assignment) {
    const Status set = document->set(assignment);
    return set ? std::string() : set.error().message;
  };
  CHECK(refused(dotted(50'000) + "=1") == "names a key of more than 16 parts");
  CHECK(refused(std::string(257, 'k') + "=1") == "names a key of more than 256 bytes");
  CHECK(refused("tool.x=" + repeated("[", 50'000) + repeated("]", 50'000)).find("not a TOML value") != std::string::npos);
  CHECK(document->unset(dotted(50'000)).error().message == "names a key of more than 16 parts");
  for (int n = 0; n < 1000; ++n) REQUIRE(refused("tool.spin_rpm=2") == "");
  CHECK(refused("tool.spin_rpm=2") == "is one of more than 1000 changes of one file");
}

TEST_CASE("text: a value with a byte 0 or of more bytes than a path may have is an issue at its key") {
  Issues issues;
  const std::string n(4096, 'n');
  const auto document = TomlDocument::parse("a = \"x\\u0000y\"\nb = \"" + n + "n\"\nc = \"" + n + "\"\n", "f.toml");
  REQUIRE(document.ok());
  TableReader root = document->root(issues);
  CHECK(root.text("a", "", "") == "");
  CHECK(root.text("b", "", "") == "");
  CHECK(root.text("c", "", "") == n);
  REQUIRE(issues.size() == 2);
  CHECK(issues[0].text() == "f.toml:1:1: a = \"x\\x00y\" contains a byte 0, where programs end a text");
  CHECK(issues[1].text().find("has 4097 bytes, at most 4096 are read") != std::string::npos);
  CHECK(issues[1].text().size() < 200);
}
