/// tests/support/real_data.h: real scans and meshes, which do not travel with the sources; $BURRHOLE_DATA says where they are.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/skip.h"

namespace burrhole {

/// A part of the data set. Where it is not there, the test program ends as skipped.
inline std::filesystem::path real_data(const std::string& part = "") {
  const char* const root = std::getenv("BURRHOLE_DATA");
  const std::filesystem::path path = root == nullptr ? std::filesystem::path() : std::filesystem::path(root) / part;
  if (root != nullptr && std::filesystem::exists(path)) return path;
  test::skip("$BURRHOLE_DATA/" + part + " is not there");
}

}  // namespace burrhole
