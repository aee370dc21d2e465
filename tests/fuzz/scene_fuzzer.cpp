// Any text as a scene: errors are values, never crashes; an accepted scene reads the same from its own text. The tables of all effects are
// read: before the first input each is demanded of a scene that has it.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "app/scene/scene.h"

namespace {

using namespace burrhole;

const SceneContext kContext{.tool_folders = {}, .tool_given = true};

std::string plate_with(const EffectEntry& effect, const std::string& lines) {
  return "[volume]\nsource = \"phantom:plate\"\n[tool]\nname = \"any\"\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n[hand]\n[" +
         std::string(effect.table) + "]\n" + lines + "\n";
}

/// Aborts unless the effect's table, empty and with each of its samples, is accepted and gives a plan.
void demand_reader(const EffectEntry& effect) {
  std::vector<std::string> texts = effect.samples;
  texts.emplace_back();
  for (const std::string& lines : texts) {
    const auto document = TomlDocument::parse(plate_with(effect, lines), "sample.toml");
    Issues issues;
    const auto scene = document ? read_scene(*document, kContext, issues) : std::nullopt;
    if (scene && scene->effects.has(effect.table)) continue;
    std::fprintf(stderr, "scene fuzzer: a sample of [%s] is refused: %s\n", effect.table, issues.empty() ? "" : issues[0].text().c_str());
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  for (const EffectEntry& effect : shipped_effects())
    if (effect.read != nullptr) demand_reader(effect);
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
