/// volumes/read/raw_sidecar.h: the TOML file that says what a raw volume's bytes are; no file access beyond it.
///   Frame   LPS; direction columns are where i, j, k point.     Units  mm in the file, m out.
///   Errors  every fault with file:line:column.
#pragma once

#include <string>
#include <vector>

#include "core/base/toml.h"
#include "volumes/read/image_file.h"

namespace burrhole {

struct RawSidecar {
  ImageHead image;
  Quantity quantity = Quantity::unknown;
  std::string data;    ///< one file, as written; empty: a file a slice
  std::string folder;  ///< of those, as written; "." when not said
  std::string files;   ///< their pattern: one * that stands for a number, "CThead.*"
  std::uint64_t offset_bytes = 0;
  std::string data_place, folder_place, files_place;  ///< file:line:column of those keys
};

/// @returns the sidecar, or its first fault and how many follow.
[[nodiscard]] Result<RawSidecar> parse_raw_sidecar(const TomlDocument& document, KeyLog* log = nullptr);

/// The words of the key `type`.
[[nodiscard]] std::vector<std::string> raw_type_names();

}  // namespace burrhole
