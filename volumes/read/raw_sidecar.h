/// volumes/read/raw_sidecar.h: the TOML file that describes the bytes of a raw volume; no other file access.
///   Frame   LPS; direction columns are the directions of i, j, k.     Units  mm in the file, m out.
///   Errors  bad_input with file:line:column.
#pragma once

#include <string>
#include <vector>

#include "core/config/toml.h"
#include "volumes/read/image_file.h"

namespace burrhole {

struct RawSidecar {
  ImageHead image;
  Quantity quantity = Quantity::unknown;
  std::string data;    ///< one file, as written; empty: one file per slice
  std::string folder;  ///< folder of the slice files, as written; "." by default
  std::string files;   ///< their pattern: one * for a number, "CThead.*"
  std::uint64_t offset_bytes = 0;
  std::string data_place, folder_place, files_place;  ///< file:line:column of those keys
};

/// @returns the sidecar, or its first error and the number of further errors.
[[nodiscard]] Result<RawSidecar> parse_raw_sidecar(const TomlDocument& document, KeyLog* log = nullptr);

/// @returns the words of the key `type`.
[[nodiscard]] std::vector<std::string> raw_type_names();

}  // namespace burrhole
