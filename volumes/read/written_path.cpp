#include "volumes/read/written_path.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace burrhole {

Result<std::string> written_path(const std::string& written, const std::string& file, const std::string& place) {
  std::string path = written;
  if (path.starts_with('$')) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string name = path.substr(1, end - 1);
    const char* const value = std::getenv(name.c_str());
    if (value == nullptr || *value == '\0') return bad_input("the environment variable " + name + " is not set", place);
    path = value + path.substr(end);
  }
  return (std::filesystem::path(file).parent_path() / path).string();  // an absolute right side replaces the left
}

}  // namespace burrhole
