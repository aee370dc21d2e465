// Any bytes as a NIfTI header: what is accepted has a usable grid.
#include <cstdlib>
#include <span>

#include "tests/fuzz/usable_head.h"
#include "volumes/read/nifti_header.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto header = burrhole::parse_nifti(std::as_bytes(std::span(data, size)));
  if (header) burrhole::demand_usable(header->image);
  return 0;
}
