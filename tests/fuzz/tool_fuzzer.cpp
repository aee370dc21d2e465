// Any text as a tool: faults are values, and an accepted tool has regions of some size, or a mesh.
#include <cstdlib>
#include <string_view>

#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  const auto document = TomlDocument::parse({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!document) return 0;
  Issues issues;
  if (has_tool_mesh(*document)) {
    if (read_mesh_tool_spec(*document, issues).has_value() != issues.empty()) std::abort();
    return 0;
  }
  const auto spec = read_tool_spec(*document, issues);
  if (spec.has_value() != issues.empty()) std::abort();
  if (!spec) return 0;
  if (spec->regions.empty()) std::abort();
  for (const RegionSpec& region : spec->regions)
    if (!(region.solid.volume() > 0.0)) std::abort();
  return 0;
}
