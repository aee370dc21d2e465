#include "tests/support/source_folder.h"

namespace burrhole::test {

namespace {

std::string join(std::string folder, std::string_view path) {
  if (!path.empty()) folder.append("/").append(path);
  return folder;
}

}  // namespace

std::string in_source(std::string_view path) { return join(BH_SOURCE_DIR, path); }
std::string in_build(std::string_view path) { return join(BH_BINARY_DIR, path); }

}  // namespace burrhole::test
