/// volumes/read/raw_sidecar.h: parses the TOML file that describes the bytes of a raw volume. It does not open the data.
///   Frame   LPS; the columns of the direction matrix are the directions of the index axes i, j, k.     Units  mm in the file, m out.
///   Errors  bad_input with file:line:column.
#pragma once

#include <string>
#include <vector>

#include "core/config/toml.h"
#include "volumes/read/image_file.h"

namespace burrhole {

struct RawSidecar {
  ImageHead image;
  Quantity quantity = Quantity::unknown;  ///< meaning of the values
  std::string data;                       ///< value of the key: path of the single data file; empty: one file per slice
  std::string folder;                     ///< value of the key: folder of the slice files, "." by default
  std::string files;  ///< name pattern of the slice files, with one * for the slice number, such as CThead.*; sorted by number
  std::uint64_t offset_bytes = 0;
  std::string data_place, folder_place, files_place;  ///< file:line:column of `data`, `folder`, `files`
};

/// @param log receives the keys that were read; may be null. @returns the sidecar, or its first error and the number of further errors.
[[nodiscard]] Result<RawSidecar> parse_raw_sidecar(const TomlDocument& document, KeyLog* log = nullptr);

/// @returns the values that the key `type` accepts.
[[nodiscard]] std::vector<std::string> raw_type_names();

}  // namespace burrhole
