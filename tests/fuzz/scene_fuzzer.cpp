// Any text as a scene: faults are values, never crashes; a scene that is accepted says the same after a round trip through its own text.
#include <cstdlib>
#include <string_view>

#include "app/scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  const auto document = TomlDocument::parse({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!document) return 0;
  Issues issues;
  const auto scene = read_scene(*document, {.tool_folders = {}, .tool_given = true}, issues);
  if (scene.has_value() != issues.empty()) std::abort();
  if (!scene) return 0;
  const auto again = TomlDocument::parse(scene->text, "fuzzed.toml");
  if (!again || !read_scene(*again, {.tool_folders = {}, .tool_given = true}, issues)) std::abort();
  return 0;
}
