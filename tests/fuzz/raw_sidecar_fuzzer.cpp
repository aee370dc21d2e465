// Any text as the description of a raw volume: what is accepted has a usable grid.
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/usable_head.h"
#include "volumes/read/raw_sidecar.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  const auto document = TomlDocument::parse({reinterpret_cast<const char*>(data), size}, "fuzzed.toml");
  if (!document) return 0;
  if (const auto sidecar = parse_raw_sidecar(*document)) demand_usable(sidecar->image);
  return 0;
}
