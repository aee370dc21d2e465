#include "volumes/read/written_path.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace burrhole {
namespace {

constexpr const char* kDataVariable = "BURRHOLE_DATA";

/// @returns the variable in "$NAME/rest"; empty for another path.
std::string variable_of(const std::string& written) {
  return written.starts_with('$') ? written.substr(1, std::min(written.find('/'), written.size()) - 1) : std::string();
}

}  // namespace

std::string missing_data_note(const std::string& written) {
  if (variable_of(written) != kDataVariable) return {};
  return "; scripts/fetch-data gets the scans of the shipped scenes";
}

Result<std::string> written_path(const std::string& written, const std::string& file, const std::string& place) {
  std::string path = written;
  if (path.starts_with('$')) {
    const std::string name = variable_of(path);
    const char* const value = std::getenv(name.c_str());
    if (value == nullptr || *value == '\0')
      return bad_input("the environment variable " + name + " is not set" + missing_data_note(written), place);
    path = value + path.substr(1 + name.size());
  }
  return (std::filesystem::path(file).parent_path() / path).string();  // an absolute right side replaces the left
}

}  // namespace burrhole
