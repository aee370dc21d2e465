// Any text as a tool: faults are values; an accepted tool has regions, and its outline stays within finite bounds.
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "core/tool/tool_spec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  const auto document = TomlDocument::parse({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!document) return 0;
  Issues issues;
  const auto spec = read_tool_spec(*document, issues);
  if (spec.has_value() != issues.empty()) std::abort();
  if (spec && spec->regions.empty()) std::abort();
  return 0;
}
