#include "app/render/shader_source.h"
#include "tests/support/source_folder.h"

#include <doctest/doctest.h>

#include <set>

using namespace burrhole;

TEST_CASE("shader source: defines come first, includes are replaced, lines keep their numbers") {
  const ShaderFiles files{{"a.frag", "one\n#include \"b.glsl\"\nthree\n"}, {"b.glsl", "inner\n"}};
  const auto text = expand_shader(files, "a.frag", {"CUT", "SKIP"});
  REQUIRE(text.ok());
  CHECK(text.value() == "#version 450 core\n#define CUT 1\n#define SKIP 1\n#line 1\none\n#line 10001\ninner\n#line 3\nthree\n");
}

TEST_CASE("shader source: a driver's error is reported by file, line and column, whichever driver it is") {
  const ShaderFiles files{{"a.frag", ""}, {"b.glsl", ""}};
  CHECK(shader_error(files, "0:3(1): warning: unused\n0:10012(7): error: syntax error, unexpected '}'\n").text() ==
        "b.glsl:12:7: error: syntax error, unexpected '}'");
  CHECK(shader_error(files, "0(41) : error C1503: undefined variable \"x\"\n").text() ==
        "a.frag:41: error C1503: undefined variable \"x\"");
  CHECK(shader_error(files, "0:90001(1): error: of no file\n").text() == "0:90001(1): error: of no file");
  CHECK_FALSE(shader_error(files, "").text().empty());
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
  CHECK(names.size() > 1);
}

TEST_CASE("shader source: what is built in is what lies in the folder") {
  const auto files = read_shader_folder(test::in_source("shaders"));
  REQUIRE(files.ok());
  CHECK(files.value() == embedded_shaders());
}

TEST_CASE("shader source: a picture that calls for nothing defines nothing") {
  CHECK(raycast_variant({}).defines.empty());
  CHECK(surface_variant({}).defines.empty());
  CHECK(surface_variant({.cut = true, .soft = true}).name == "surface_cut_soft");
}

TEST_CASE("shader source: of a branch that is not taken nothing is left but empty lines") {
  const ShaderFiles files{{"a.frag", "#ifdef X\n#ifndef Y\n#include \"b.glsl\"\n#else\nboth\n#endif\n#else\nneither\n#endif\nend\n"},
                          {"b.glsl", "one\n"}};
  const auto with = [&](const std::vector<std::string>& defines) {
    const std::string text = expand_shader(files, "a.frag", defines).value();
    return text.substr(text.find("#line 1\n") + 8);
  };
  CHECK(with({"X"}) == "\n\n#line 10001\none\n#line 4\n\n\n\n\n\n\nend\n");
  CHECK(with({"X", "Y"}) == "\n\n\n\nboth\n\n\n\n\nend\n");
  CHECK(with({}) == "\n\n\n\n\n\n\nneither\n\nend\n");
}

TEST_CASE("shader source: a branch that is not closed, or closed twice, is named with its place") {
  CHECK(expand_shader({{"a.frag", "#ifdef X\n"}}, "a.frag", {}).error().text() == "a.frag: a branch is not closed");
  CHECK(expand_shader({{"a.frag", "\n#endif\n"}}, "a.frag", {}).error().text() == "a.frag:2: #endif without a branch");
  // A file may not end what the file that includes it began.
  CHECK_FALSE(expand_shader({{"a.frag", "#ifdef X\n#include \"b.glsl\"\n#endif\n"}, {"b.glsl", "#endif\n"}}, "a.frag", {"X"}).ok());
}

namespace {

/// What only the named look brings into the source of a surface.
struct LookWord {
  const char* word;
  Appearance appearance;
};

std::string surface_source(const Appearance& appearance) {
  return expand_shader(embedded_shaders(), "surface.frag", surface_variant({.appearance = appearance}).defines).value();
}

}  // namespace

TEST_CASE("shader source: an appearance option that is off is not in the source, one that is on is") {
  const Appearance none{.labels = false};
  std::vector<LookWord> words{{"sampler3D tissue", none},
                              {"open_sky(", none},
                              {"light_reaching(", none},
                              {"pow(max(dot(normal, normalize(light.xyz + to_eye))", none},
                              {"textureLod(color_soft, texture_from_index(inside)", none}};
  words[0].appearance.tissue = words[1].appearance.occlusion = words[2].appearance.shadow = words[3].appearance.specular =
      words[4].appearance.labels = true;
  for (const LookWord& look : words) {
    CHECK(surface_source(none).find(look.word) == std::string::npos);
    CHECK(surface_source(look.appearance).find(look.word) != std::string::npos);
    for (const LookWord& other : words)
      if (other.word != look.word) CHECK(surface_source(other.appearance).find(look.word) == std::string::npos);
  }
  // The shadow of the tool is computed where it may fall, and not in the picture of the bone.
  CHECK(surface_source({.shadow = true}).find("light_past_tool(") == std::string::npos);
  const auto shaded = expand_shader(embedded_shaders(), "surface.frag", surface_variant({.tool_shadow = true}).defines);
  REQUIRE(shaded.ok());
  CHECK(shaded->find("light_past_tool(") != std::string::npos);
  // Cloth has a pattern where tissue has one; a table is in the background alone, and only if asked for.
  constexpr const char* kCloth = "if (color.g > color.r) return";
  CHECK(surface_source({.tissue = true}).find(kCloth) == std::string::npos);
  CHECK(surface_source({.drape = true}).find(kCloth) == std::string::npos);
  CHECK(surface_source({.tissue = true, .drape = true}).find(kCloth) != std::string::npos);
  const auto rays = [](bool table) {
    return expand_shader(embedded_shaders(), "raycast.frag", raycast_variant({.table = table}).defines).value();
  };
  CHECK(rays(false).find("table_color.rgb") == std::string::npos);
  CHECK(rays(true).find("table_color.rgb") != std::string::npos);
  // Recomputed normals look up no stored one for the surface; stored ones are the only ones otherwise.
  Appearance recomputed = none;
  recomputed.normals = NormalSource::recomputed;
  CHECK(surface_source(none).find("vec3 n = stored_normal(p);") != std::string::npos);
  CHECK(surface_source(recomputed).find("vec3 n = stored_normal(p);") == std::string::npos);
}

TEST_CASE("shader source: no loop comes after a discard, for which Mesa's compiler would take a minute") {
  const auto fault = [](const std::string& text) {
    const std::size_t first = text.find("discard;"), loop = std::max(text.rfind("for (") + 1, text.rfind("while (") + 1);
    return first != std::string::npos && loop > first;
  };
  CHECK(fault("if (a) discard;\nfor (;;) {}"));
  CHECK_FALSE(fault("for (;;) {}\nif (a) discard;"));
  int discarding = 0;
  for (const ShaderVariant& variant : all_shader_variants()) {
    const auto text = expand_shader(embedded_shaders(), variant.fragment, variant.defines);
    REQUIRE(text.ok());
    discarding += text->find("discard;") != std::string::npos ? 1 : 0;
    CHECK_MESSAGE(!fault(*text), variant.name);
  }
  CHECK(discarding > 10);
}
