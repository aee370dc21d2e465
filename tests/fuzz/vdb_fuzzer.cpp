// Any bytes as a .vdb file: what our own check of its header accepts before OpenVDB reads it. OpenVDB is not built with the fuzzer's
// instruments and stays out.
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>

#include "core/voxel/vdb_header.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  const auto fault = vdb_header_fault(in, size);
  if (fault && (fault->empty() || fault->find('\n') != std::string::npos)) std::abort();
  if (fault) return 0;
  // Magic, version, library, offsets, identity and two counts: no shorter file is one.
  constexpr std::size_t kLeast = 8 + 4 + 8 + 1 + 36 + 4 + 4;
  std::uint32_t version = 0;
  if (size < kLeast) std::abort();
  std::memcpy(&version, data + 8, sizeof version);
  if (std::memcmp(data, " BDV\0\0\0\0", 8) != 0 || version < kOldestVdbVersion || version > kNewestVdbVersion) std::abort();
  return 0;
}
