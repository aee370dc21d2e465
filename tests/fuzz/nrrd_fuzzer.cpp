// Any text as an NRRD header: what is accepted has a usable grid, and its data does not start behind the text.
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/usable_head.h"
#include "volumes/read/nrrd_header.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto header = burrhole::parse_nrrd({reinterpret_cast<const char*>(data), size});
  if (!header) return 0;
  burrhole::demand_usable(header->image);
  if (header->header_bytes > size) std::abort();
  return 0;
}
