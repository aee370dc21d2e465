// Any text as a scene: errors are values, never crashes; an accepted scene reads the same from its own text. The tables of all effects are
// read: before the first input the sample of each branch of the reader must be accepted.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "app/scene/scene.h"
#include "app/scene/schema_samples.h"

namespace {

using namespace burrhole;

const SceneContext kContext{.tool_folders = {}, .tool_given = true};

/// Aborts if a valid scene is refused for another reason than a file of it that is not here.
void demand_reader(const SchemaSample& sample) {
  const Issues issues = read_sample(SchemaFile::scene, sample.text).issues;
  const std::string said = issues.empty() ? "" : issues[0].text();
  if (issues.empty() || (!sample.expected_error.empty() && issues.size() == 1 && said.find(sample.expected_error) != std::string::npos))
    return;
  std::fprintf(stderr, "scene fuzzer: the sample \"%s\" is refused: %s\n", sample.name.c_str(), said.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  for (const SchemaSample& sample : schema_samples(SchemaFile::scene)) demand_reader(sample);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto document = TomlDocument::parse({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!document) return 0;
  Issues issues;
  const auto scene = read_scene(*document, kContext, issues);
  if (scene.has_value() != issues.empty()) std::abort();
  if (!scene) return 0;
  const auto again = TomlDocument::parse(scene->text, "fuzzed.toml");
  if (!again || !read_scene(*again, kContext, issues)) std::abort();
  return 0;
}
