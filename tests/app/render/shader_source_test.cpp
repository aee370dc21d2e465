#include "app/render/shader_source.h"

#include <doctest/doctest.h>

#include <set>

using namespace burrhole;

TEST_CASE("shader source: defines come first, includes are replaced, lines keep their numbers") {
  const ShaderFiles files{{"a.frag", "one\n#include \"b.glsl\"\nthree\n"}, {"b.glsl", "inner\n"}};
  const auto text = expand_shader(files, "a.frag", {"CUT", "SKIP"});
  REQUIRE(text.ok());
  CHECK(text.value() == "#version 450 core\n#define CUT 1\n#define SKIP 1\n#line 1\none\n#line 10001\ninner\n#line 3\nthree\n");
}

TEST_CASE("shader source: a driver's fault is told by file, line and column, whichever driver it is") {
  const ShaderFiles files{{"a.frag", ""}, {"b.glsl", ""}};
  CHECK(shader_fault(files, "0:3(1): warning: unused\n0:10012(7): error: syntax error, unexpected '}'\n").text() ==
        "b.glsl:12:7: error: syntax error, unexpected '}'");
  CHECK(shader_fault(files, "0(41) : error C1503: undefined variable \"x\"\n").text() ==
        "a.frag:41: error C1503: undefined variable \"x\"");
  CHECK(shader_fault(files, "0:90001(1): error: of no file\n").text() == "0:90001(1): error: of no file");
  CHECK_FALSE(shader_fault(files, "").text().empty());
}

TEST_CASE("shader source: a missing include is named with its place") {
  const auto text = expand_shader({{"a.frag", "\n#include \"gone.glsl\"\n"}}, "a.frag", {});
  REQUIRE_FALSE(text.ok());
  CHECK(text.error().text() == "a.frag:2: no shader file \"gone.glsl\"");
}

TEST_CASE("shader source: a file that includes itself is refused") {
  CHECK_FALSE(expand_shader({{"a.glsl", "#include \"a.glsl\"\n"}}, "a.glsl", {}).ok());
}

TEST_CASE("shader source: variants have names of their own and expand from what is built in") {
  std::set<std::string> names;
  for (const ShaderVariant& variant : all_shader_variants()) {
    CHECK(names.insert(variant.name).second);
    CHECK(expand_shader(embedded_shaders(), variant.vertex, variant.defines).ok());
    CHECK(expand_shader(embedded_shaders(), variant.fragment, variant.defines).ok());
  }
}

TEST_CASE("shader source: what is built in is what lies in the folder") {
  const auto files = read_shader_folder(BH_SOURCE_DIR "/shaders");
  REQUIRE(files.ok());
  CHECK(files.value() == embedded_shaders());
}

TEST_CASE("shader source: a picture that calls for nothing defines nothing") {
  CHECK(raycast_variant({}).defines.empty());
  CHECK(raycast_variant({.cut = true, .soft = true}).name == "raycast_cut_soft");
}
